#include "apps/yaml_reader.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <set>
#include <sstream>

#include "apps/nearest_word.h"

namespace trueblade {
namespace {

constexpr std::uintmax_t kLargestFile = 1u << 20;  // bytes; a scenario has a few thousand
constexpr std::size_t kDeepestNesting = 20;        // levels; a scenario has five

struct YamlNode {
  enum class Kind { empty, scalar, list, map };
  Kind kind = Kind::empty;
  int line = 1;
  std::string text;               // of a scalar
  std::vector<std::string> keys;  // of a map, one per item
  std::vector<int> key_lines;
  std::vector<YamlNode> items;  // of a list or map
};

std::string kind_words(YamlNode::Kind kind) {
  switch (kind) {
    case YamlNode::Kind::empty:
      return "empty";
    case YamlNode::Kind::scalar:
      return "a single value";
    case YamlNode::Kind::list:
      return "a list";
    case YamlNode::Kind::map:
      return "a map";
  }
  return "";
}

// Builds the tree from yaml-cpp's events, so that limits hold while the text is still being read.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& file) : file_(file) {}

  YamlNode root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse_decimal_comma(mark);
    value(mark, {}, YamlNode::Kind::empty, "");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse_anchor(mark); }
  void OnAnchor(const YAML::Mark& mark, const std::string&) override { refuse_anchor(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& text) override {
    value(mark, tag, YamlNode::Kind::scalar, text);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    open_.push_back(value(mark, tag, YamlNode::Kind::list, ""));
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    open_.push_back(value(mark, tag, YamlNode::Kind::map, ""));
    awaits_key_.push_back(true);
    first_lines_.emplace_back();
  }
  void OnMapEnd() override {
    open_.pop_back();
    awaits_key_.pop_back();
    first_lines_.pop_back();
  }

 private:
  static int line_of(const YAML::Mark& mark) { return mark.line + 1; }

  [[noreturn]] void refuse_anchor(const YAML::Mark& mark) const {
    throw line_error(file_, line_of(mark), "anchors (&) and aliases (*) are not supported");
  }

  // In {spacing_mm: 0,5} YAML sees the value 0 and a key 5 without a value.
  void refuse_decimal_comma(const YAML::Mark& mark) const {
    if (open_.empty() || open_.back()->kind != YamlNode::Kind::map || awaits_key_.back()) return;
    const YamlNode& map = *open_.back();
    if (map.items.empty() || map.items.back().kind != YamlNode::Kind::scalar) return;
    const std::string text = map.items.back().text + ',' + map.keys.back();
    if (const auto meant = with_decimal_point(text))
      throw line_error(file_, line_of(mark),
                       fmt::format("{} is \"{}\", must be a number with a decimal point: {}",
                                   map.keys[map.keys.size() - 2], text, *meant));
  }

  // Takes the next event as a map's key or as a value; returns the new value's node. Pointers into `items`
  // stay valid while the node is open, because only the innermost open node grows.
  YamlNode* value(const YAML::Mark& mark, const std::string& tag, YamlNode::Kind kind,
                  const std::string& text) {
    const int line = line_of(mark);
    const bool explicit_tag = !tag.empty() && tag != "?" && tag != "!";
    if (explicit_tag) throw line_error(file_, line, "tag \"" + tag + "\" is not supported");
    if (open_.size() >= kDeepestNesting)
      throw line_error(file_, line, fmt::format("nested deeper than {} levels", kDeepestNesting));

    if (open_.empty()) {
      root = {kind, line, text, {}, {}, {}};
      return &root;
    }
    YamlNode& parent = *open_.back();
    if (parent.kind == YamlNode::Kind::map && awaits_key_.back()) {
      take_key(parent, line, kind, text);
      return nullptr;
    }
    if (parent.kind == YamlNode::Kind::map) awaits_key_.back() = true;
    parent.items.push_back({kind, line, text, {}, {}, {}});
    return &parent.items.back();
  }

  void take_key(YamlNode& map, int line, YamlNode::Kind kind, const std::string& text) {
    if (kind != YamlNode::Kind::scalar) throw line_error(file_, line, "a key must be a single word");
    const auto [known, is_new] = first_lines_.back().try_emplace(text, line);
    if (!is_new)
      throw line_error(file_, line,
                       fmt::format("key \"{}\" is given twice, first in line {}", text, known->second));
    map.keys.push_back(text);
    map.key_lines.push_back(line);
    awaits_key_.back() = false;
  }

  std::string file_;
  std::vector<YamlNode*> open_;
  // One per open map:
  std::vector<bool> awaits_key_;
  std::vector<std::map<std::string, int>> first_lines_;  // where each of its keys stands
};

// Reads one map of the tree, remembers which keys were asked for, and at the end refuses the others.
class MapReader final : public YamlFields {
 public:
  MapReader(const YamlNode& map, const std::string& file, std::string name)
      : map_(map), file_(file), name_(std::move(name)) {}

  bool reading() const override { return true; }
  bool present(std::string_view key) override { return find(key) != nullptr; }
  bool holds_foreign(std::string_view key) const override {
    return std::find(map_.keys.begin(), map_.keys.end(), key) != map_.keys.end();
  }
  void require(std::string_view key) override {
    if (!present(key)) deferred_.push_back(fmt::format("{} is missing", full_name(key)));
  }
  void fail_unless(bool holds, const std::string& message) override {
    if (!holds) deferred_.push_back(message);
  }

  InputError error(std::string_view key, const std::string& message) const override {
    const bool begins_with_key = message.starts_with(key) && message.substr(key.size()).starts_with(' ');
    return file_error(place(key), begins_with_key ? full_name(message) : message);
  }
  std::string place(std::string_view key) const override {
    return fmt::format("{}:{}", file_, line_of(map_, key).value_or(map_.line));
  }
  InputError error_about(const std::string& message) const override {
    constexpr std::string_view kBetweenWords = " :,;()[]{}\"'=";
    for (std::size_t begin = 0; begin < message.size();) {
      const std::size_t end = std::min(message.find_first_of(kBetweenWords, begin), message.size());
      const std::string word = message.substr(begin, end - begin);
      if (const auto line = line_of(map_, word)) {
        // A bare word within a sentence may be a key by chance.
        const bool is_meant = begin == 0 || word.find_first_of("._") != std::string::npos;
        return line_error(file_, *line,
                          is_meant ? message.substr(0, begin) + full_name(message.substr(begin)) : message);
      }
      begin = end + 1;
    }
    return line_error(file_, map_.line, message);
  }

  void map(std::string_view key, const MapFunction& fields_of_map) override {
    const YamlNode* node = find(key, YamlNode::Kind::map);
    if (!node) return;
    read_map(*node, full_name(key), fields_of_map);
  }

  // The keys that nobody asked for; then what is missing.
  void finish() const {
    for (std::size_t i = 0; i < map_.keys.size(); ++i)
      if (!asked_.contains(map_.keys[i])) throw unknown_key(map_.keys[i], map_.key_lines[i]);
    if (!deferred_.empty()) throw line_error(file_, map_.line, deferred_.front());
  }

 protected:
  bool scalar(std::string_view key, std::string& text) override {
    const YamlNode* node = find(key, YamlNode::Kind::scalar);
    if (node) text = node->text;
    return node != nullptr;
  }

  bool scalars(std::string_view key, std::vector<std::string>& texts) override {
    const YamlNode* node = find(key, YamlNode::Kind::list);
    if (!node) return false;
    texts.clear();
    for (const YamlNode& item : node->items) {
      if (item.kind != YamlNode::Kind::scalar)
        throw line_error(file_, item.line,
                         fmt::format("an item of {} is {}, must be a single value", full_name(key),
                                     kind_words(item.kind)));
      texts.push_back(item.text);
    }
    return true;
  }

  void maps(std::string_view key, std::size_t, const std::function<void(std::size_t)>& resize,
            const IndexFunction& fields_of_item) override {
    const YamlNode* node = find(key, YamlNode::Kind::list);
    if (!node) return;
    resize(node->items.size());
    for (std::size_t i = 0; i < node->items.size(); ++i)
      read_map(node->items[i], fmt::format("{}[{}]", full_name(key), i),
               [&](YamlFields& io) { fields_of_item(io, i); });
  }

  void named_maps(std::string_view key, const std::vector<std::string>&,
                  const NameFunction& fields_of_item) override {
    const YamlNode* node = find(key, YamlNode::Kind::map);
    if (!node) return;
    for (std::size_t i = 0; i < node->items.size(); ++i)
      read_map(node->items[i], full_name(key) + "." + node->keys[i],
               [&](YamlFields& io) { fields_of_item(io, node->keys[i]); });
  }

 private:
  std::string full_name(std::string_view key) const {
    return name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
  }

  const YamlNode* find(std::string_view key) {
    asked_.emplace(key);
    const auto place = std::find(map_.keys.begin(), map_.keys.end(), key);
    if (place == map_.keys.end()) return nullptr;
    return &map_.items[static_cast<std::size_t>(place - map_.keys.begin())];
  }

  const YamlNode* find(std::string_view key, YamlNode::Kind kind) {
    const YamlNode* node = find(key);
    if (node && node->kind != kind)
      throw error(
          key, fmt::format("{} is {}, must be {}", full_name(key), kind_words(node->kind), kind_words(kind)));
    return node;
  }

  void read_map(const YamlNode& node, const std::string& name, const MapFunction& fields_of_map) const {
    if (node.kind != YamlNode::Kind::map)
      throw line_error(file_, node.line, fmt::format("{} is {}, must be a map", name, kind_words(node.kind)));
    MapReader reader(node, file_, name);
    fields_of_map(reader);
    reader.finish();
  }

  // Where the key stands, or the first part of "key.inner_key". The libraries speak of fields in radians; the
  // key in the file is in degrees. Names that a user chooses may hold dots themselves.
  static std::optional<int> line_of(const YamlNode& map, std::string_view path) {
    for (std::size_t i = 0; i < map.keys.size(); ++i)
      if (map.keys[i] == path) return map.key_lines[i];
    const std::size_t dot = path.find('.');
    std::string key(path.substr(0, dot));
    if (key.ends_with("_rad")) key.replace(key.size() - 4, 4, "_deg");
    for (std::size_t i = 0; i < map.keys.size(); ++i) {
      if (map.keys[i] != key) continue;
      if (dot == std::string_view::npos) return map.key_lines[i];
      return line_of(map.items[i], path.substr(dot + 1)).value_or(map.key_lines[i]);
    }
    return std::nullopt;
  }

  InputError unknown_key(const std::string& key, int line) const {
    const std::vector<std::string> valid(asked_.begin(), asked_.end());
    const auto nearest = nearest_word(key, valid);
    return line_error(
        file_, line,
        fmt::format("unknown key \"{}\"{}{}; valid keys are {}", key,
                    name_.empty() ? "" : fmt::format(" in {}", name_),
                    nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : "", fmt::join(valid, ", ")));
  }

  const YamlNode& map_;
  const std::string& file_;
  std::string name_;
  std::set<std::string, std::less<>> asked_;
  std::vector<std::string> deferred_;
};

std::string read_text(const std::filesystem::path& file) {
  std::error_code failure;
  const auto status = std::filesystem::status(file, failure);
  if (!std::filesystem::exists(status)) throw file_error(file.string(), "no such file");
  if (!std::filesystem::is_regular_file(status)) throw file_error(file.string(), "is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, failure);
  if (failure) throw file_error(file.string(), failure.message());
  if (size > kLargestFile)
    throw file_error(file.string(), fmt::format("has {} bytes, must have at most {}", size, kLargestFile));
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw file_error(file.string(), "cannot be opened for reading");
  std::string text(size, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(size));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

// The first line up to `last` (from 1) that is indented with a tab: the usual cause where YAML then complains
// about something else.
std::optional<int> line_indented_with_tab(const std::string& text, int last) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; number <= last && std::getline(lines, line); ++number) {
    const std::size_t tab = line.find('\t');
    if (tab != std::string::npos && line.find_first_not_of(' ') == tab) return number;
  }
  return std::nullopt;
}

YamlNode parse_document(const std::string& text, const std::string& file) {
  if (text.find('\0') != std::string::npos) throw file_error(file, "is not text");
  std::istringstream stream(text);
  TreeBuilder builder(file);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) throw file_error(file, "is empty");
    TreeBuilder second(file);
    if (parser.HandleNextDocument(second))
      throw line_error(file, second.root.line, "a second document begins, must be one");
  } catch (const YAML::Exception& failure) {
    if (const auto tab = line_indented_with_tab(text, failure.mark.line + 1))
      throw line_error(file, *tab, "is indented with a tab, must be with spaces (YAML)");
    throw line_error(file, failure.mark.line + 1, "not valid YAML: " + failure.msg);
  }
  return builder.root;
}

// The node at a path; keys that are absent are added, places of lists must exist.
YamlNode& node_at(YamlNode& root, const std::string& path) {
  YamlNode* node = &root;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, end - begin);
    begin = end + 1;
    if (node->kind == YamlNode::Kind::list) {
      std::size_t place = 0;
      const auto [rest, failure] = std::from_chars(key.data(), key.data() + key.size(), place);
      if (failure != std::errc() || rest != key.data() + key.size() || place >= node->items.size())
        throw InputError(fmt::format("{}: \"{}\" must be a place in a list of {}, counted from 0", path, key,
                                     node->items.size()));
      node = &node->items[place];
      continue;
    }
    if (node->kind == YamlNode::Kind::empty) node->kind = YamlNode::Kind::map;
    if (node->kind != YamlNode::Kind::map)
      throw InputError(fmt::format("{}: there is nothing inside {} to be called \"{}\"", path,
                                   kind_words(node->kind), key));
    const auto known = std::find(node->keys.begin(), node->keys.end(), key);
    if (known != node->keys.end()) {
      node = &node->items[static_cast<std::size_t>(known - node->keys.begin())];
      continue;
    }
    node->keys.push_back(key);
    node->key_lines.push_back(node->line);
    node->items.push_back({YamlNode::Kind::empty, node->line, "", {}, {}, {}});
    node = &node->items.back();
  }
  return *node;
}

void read_document(const YamlNode& root, const std::string& file, const YamlFields::MapFunction& fields) {
  if (root.kind == YamlNode::Kind::empty) throw file_error(file, "is empty");
  if (root.kind != YamlNode::Kind::map)
    throw line_error(file, root.line, "holds " + kind_words(root.kind) + ", must be a map of keys");
  MapReader reader(root, file, "");
  fields(reader);
  reader.finish();
}

}  // namespace

void read_yaml_text(const std::string& text, const std::string& file, const YamlFields::MapFunction& fields) {
  const YamlNode root = parse_document(text, file);
  read_document(root, file, fields);
}

void read_yaml(const std::filesystem::path& file, const YamlFields::MapFunction& fields) {
  read_yaml(file, {}, fields);
}

void read_yaml(const std::filesystem::path& file, const std::vector<YamlOverride>& overrides,
               const YamlFields::MapFunction& fields) {
  YamlNode root = parse_document(read_text(file), file.string());
  for (const YamlOverride& item : overrides) {
    YamlNode value = parse_document(item.value, item.path);
    YamlNode& place = node_at(root, item.path);
    value.line = place.line;
    place = value;
  }
  read_document(root, file.string(), fields);
}

}  // namespace trueblade
