#include "apps/registration_fields.h"

#include "apps/yaml_reader.h"

namespace trueblade {
namespace {

// Hands every field of the options to the YAML by its type.
class OptionVisitor {
 public:
  explicit OptionVisitor(YamlFields& io) : io_(io) {}

  void operator()(std::string_view name, double& value) {
    const bool is_angle = name.ends_with("_rad");
    if (is_angle)
      io_.angle(std::string(name.substr(0, name.size() - 4)) + "_deg", value);
    else
      io_.number(name, value);
  }
  void operator()(std::string_view name, std::optional<double>& value) { io_.number(name, value); }
  void operator()(std::string_view name, bool& value) { io_.flag(name, value); }
  void operator()(std::string_view name, int& value) {
    io_.integer(name, value, 0, std::numeric_limits<int>::max());
  }
  void operator()(std::string_view name, std::int64_t& value) {
    io_.integer(name, value, 0, std::numeric_limits<std::int64_t>::max());
  }
  void operator()(std::string_view name, std::vector<std::uint32_t>& values) { io_.integers(name, values); }
  void operator()(std::string_view name, RigidTransform& pose) { io_.pose(name, pose); }

  template <NamedChoice Choice>
  void operator()(std::string_view name, Choice& value) {
    std::vector<std::pair<std::string_view, Choice>> names;
    for (const auto& entry : choice_names(Choice{})) names.emplace_back(entry.name, entry.choice);
    io_.choice<Choice>(name, value, names);
  }
  template <NamedChoice Choice>
  void operator()(std::string_view name, std::vector<Choice>& values) {
    std::vector<std::string> texts;
    for (const Choice value : values) texts.push_back(to_string(value));
    io_.texts(name, texts);
    values.clear();
    io_.check([&] {
      for (const std::string& text : texts) values.push_back(parse_choice<Choice>(text, name));
    });
  }
  template <class Group>
  requires requires(Group& group, OptionVisitor visitor) { Group::fields(group, visitor); }
  void operator()(std::string_view name, Group& group) {
    io_.map(name, [&](YamlFields& inner) { Group::fields(group, OptionVisitor(inner)); });
  }

 private:
  YamlFields& io_;
};

}  // namespace

void fields(YamlFields& io, RegistrationSpec& spec) {
  io.text("preset", spec.preset);
  if (io.reading()) io.check([&] { spec.options = preset(spec.preset); });
  RegistrationOptions::fields(spec.options, OptionVisitor(io));
  io.check([&] { spec.options.validate(); });
}

RegistrationSpec read_registration_options(const std::filesystem::path& file) {
  RegistrationSpec spec;
  read_yaml(file, [&](YamlFields& io) { fields(io, spec); });
  return spec;
}

}  // namespace trueblade
