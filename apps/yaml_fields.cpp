#include "apps/yaml_fields.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "apps/nearest_word.h"

namespace trueblade {

namespace {

std::optional<double> parse_finite(const std::string& text) {
  double value = 0.0;
  const char* first = text.data();
  const char* last = first + text.size();
  if (first != last && *first == '+') ++first;
  const auto [end, failure] = std::from_chars(first, last, value);
  if (failure != std::errc() || end != last || !std::isfinite(value)) return std::nullopt;
  return value;
}

// Of a list with a wrong count: [0,5, 1, 2] are four numbers to YAML.
std::string count_words(std::string_view key, const std::vector<std::string>& texts, std::size_t wanted) {
  std::string words = fmt::format("{} has {} numbers, must have {}", key, texts.size(), wanted);
  if (texts.size() > wanted)
    words +=
        fmt::format("; they are read as {} (decimals take a point, not a comma)", fmt::join(texts, " and "));
  return words;
}

}  // namespace

NumberConstraint any_number() {
  return {[](double) { return true; }, "finite"};
}
NumberConstraint above(double bound) {
  return {[bound](double value) { return value > bound; }, fmt::format("above {}", bound)};
}
NumberConstraint at_least(double bound) {
  return {[bound](double value) { return value >= bound; }, fmt::format("at least {}", bound)};
}
NumberConstraint between(double low, double high) {
  return {[low, high](double value) { return value >= low && value <= high; },
          fmt::format("from {} to {}", low, high)};
}

std::optional<std::string> with_decimal_point(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return std::nullopt;
  std::string with_point = text;
  with_point[comma] = '.';
  if (!parse_finite(with_point)) return std::nullopt;
  return with_point;
}

std::string number_text(double value) {
  return fmt::format("{}", value);
}

double radians_from_degrees(double degrees) {
  return degrees * (std::numbers::pi / 180.0);
}

std::string degrees_text(double radians) {
  const double degrees = radians * (180.0 / std::numbers::pi);
  // 15 digits are what a person wrote; they come first so that 0.2 stays 0.2.
  const double short_degrees = std::stod(fmt::format("{:.15g}", degrees));
  if (radians_from_degrees(short_degrees) == radians) return number_text(short_degrees);
  // The product above and its inverse round once each: the exact partner lies within two neighbours.
  double candidate = std::nextafter(std::nextafter(degrees, -INFINITY), -INFINITY);
  for (int neighbour = 0; neighbour < 5; ++neighbour) {
    if (radians_from_degrees(candidate) == radians) return number_text(candidate);
    candidate = std::nextafter(candidate, INFINITY);
  }
  return number_text(degrees);
}

namespace {

template <class Integer>
std::optional<Integer> parse_integer(const std::string& text) {
  Integer value{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

void YamlFields::check(const std::function<void()>& validate) const {
  try {
    validate();
  } catch (const InputError& failure) {
    throw error_about(failure.what());
  }
}

double YamlFields::parse(std::string_view key, const std::string& text,
                         const NumberConstraint& constraint) const {
  const std::optional<double> value = parse_finite(text);
  if (const auto meant = value ? std::nullopt : with_decimal_point(text))
    throw error(key,
                fmt::format("{} is \"{}\", must be a number with a decimal point: {}", key, text, *meant));
  if (!value) throw error(key, fmt::format("{} is \"{}\", must be a finite number", key, text));
  if (!constraint.holds(*value))
    throw error(key, fmt::format("{} is {}, must be {}", key, text, constraint.words));
  return *value;
}

void YamlFields::number(std::string_view key, double& value, const NumberConstraint& constraint) {
  std::string text = number_text(value);
  if (scalar(key, text) && reading()) value = parse(key, text, constraint);
}

void YamlFields::number(std::string_view key, std::optional<double>& value,
                        const NumberConstraint& constraint) {
  if (!reading() && !value) return;
  std::string text = number_text(value.value_or(0.0));
  if (scalar(key, text) && reading()) value = parse(key, text, constraint);
}

void YamlFields::angle(std::string_view key, double& value_rad, const NumberConstraint& constraint) {
  std::string text = degrees_text(value_rad);
  if (scalar(key, text) && reading()) value_rad = radians_from_degrees(parse(key, text, constraint));
}

void YamlFields::angle(std::string_view key, std::optional<double>& value_rad,
                       const NumberConstraint& constraint) {
  if (reading() && present(key)) value_rad.emplace();
  if (value_rad) angle(key, *value_rad, constraint);
}

template <class Integer>
void YamlFields::whole_number(std::string_view key, Integer& value, Integer least, Integer most) {
  std::string text = fmt::format("{}", value);
  if (!scalar(key, text) || !reading()) return;
  const auto parsed = parse_integer<Integer>(text);
  if (!parsed || *parsed < least || *parsed > most)
    throw error(key, fmt::format("{} is {}, must be a whole number from {} to {}", key, text, least, most));
  value = *parsed;
}

void YamlFields::integer(std::string_view key, std::uint64_t& value, std::uint64_t least,
                         std::uint64_t most) {
  whole_number(key, value, least, most);
}
void YamlFields::integer(std::string_view key, std::int64_t& value, std::int64_t least, std::int64_t most) {
  whole_number(key, value, least, most);
}
void YamlFields::integer(std::string_view key, int& value, int least, int most) {
  whole_number(key, value, least, most);
}

void YamlFields::integers(std::string_view key, std::vector<std::uint32_t>& values) {
  std::vector<std::string> texts;
  for (const std::uint32_t value : values) texts.push_back(fmt::format("{}", value));
  if (!scalars(key, texts) || !reading()) return;
  values.clear();
  for (const std::string& text : texts) {
    const auto parsed = parse_integer<std::uint32_t>(text);
    if (!parsed) throw error(key, fmt::format("{} holds \"{}\", must be whole numbers from 0", key, text));
    values.push_back(*parsed);
  }
}

void YamlFields::flag(std::string_view key, bool& value) {
  std::string text = value ? "true" : "false";
  if (!scalar(key, text) || !reading()) return;
  if (text != "true" && text != "false")
    throw error(key, fmt::format("{} is \"{}\", must be true or false", key, text));
  value = text == "true";
}

void YamlFields::text(std::string_view key, std::string& value) {
  scalar(key, value);
}

bool YamlFields::numbers(std::string_view key, std::span<double> values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_text(value));
  if (!scalars(key, texts) || !reading()) return false;
  if (texts.size() != values.size()) throw error(key, count_words(key, texts, values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = parse(key, texts[i], any_number());
  return true;
}

void YamlFields::path(std::string_view key, std::filesystem::path& file,
                      const std::filesystem::path& folder) {
  std::string name = file.string();
  text(key, name);
  if (name.empty()) return;
  file = std::filesystem::absolute(folder / name).lexically_normal();
}

void YamlFields::vector(std::string_view key, Vec3& value) {
  numbers(key, {value.data(), 3});
}

void YamlFields::angles(std::string_view key, Vec3& value_rad) {
  std::vector<std::string> texts;
  for (const double radians : value_rad) texts.push_back(degrees_text(radians));
  if (!scalars(key, texts) || !reading()) return;
  if (texts.size() != 3) throw error(key, count_words(key, texts, 3));
  for (int i = 0; i < 3; ++i)
    value_rad[i] = radians_from_degrees(parse(key, texts[static_cast<std::size_t>(i)], any_number()));
}

void YamlFields::interval(std::string_view key, std::optional<std::pair<double, double>>& value) {
  if (!reading() && !value) return;
  std::array<double, 2> ends{};
  if (value) ends = {value->first, value->second};
  if (!numbers(key, ends)) return;
  if (ends[0] > ends[1])
    throw error(key, fmt::format("{} is [{}, {}], must be [low, high]", key, ends[0], ends[1]));
  value = {ends[0], ends[1]};
}

void YamlFields::texts(std::string_view key, std::vector<std::string>& values) {
  scalars(key, values);
}

void YamlFields::numbers(std::string_view key, std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_text(value));
  if (!scalars(key, texts) || !reading()) return;
  values.clear();
  for (const std::string& text : texts) values.push_back(parse(key, text, any_number()));
}

void YamlFields::pose(std::string_view key, RigidTransform& target_from_source) {
  map(key, [&](YamlFields& io) {
    const Eigen::Quaterniond& rotation = target_from_source.rotation;
    std::array<double, 4> wxyz{rotation.w(), rotation.x(), rotation.y(), rotation.z()};
    if (io.numbers("rotation_wxyz", wxyz)) {
      const Eigen::Quaterniond given(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
      // 1e-3 forgives numbers rounded to four digits; a larger departure is not a rotation.
      if (std::abs(given.norm() - 1.0) > 1e-3)
        throw io.error("rotation_wxyz",
                       fmt::format("rotation_wxyz has length {}, must be a unit quaternion", given.norm()));
      // Numbers that are unit to rounding stay as they are, so that a written pose reads back to itself.
      const bool unit_to_rounding = std::abs(given.squaredNorm() - 1.0) < 1e-14;
      target_from_source.rotation = unit_to_rounding ? given : given.normalized();
    }
    io.vector("translation_mm", target_from_source.translation_mm);
  });
}

void YamlFields::fail_choice(std::string_view key, const std::string& text,
                             const std::vector<std::string>& valid) const {
  const auto nearest = nearest_word(text, valid);
  throw error(key, fmt::format("{} is \"{}\", {}must be one of {}", key, text,
                               nearest ? fmt::format("did you mean \"{}\"? It ", *nearest) : "",
                               fmt::join(valid, ", ")));
}

}  // namespace trueblade
