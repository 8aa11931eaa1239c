#include "apps/yaml_writer.h"

#include <yaml-cpp/emitter.h>
#include <yaml-cpp/emittermanip.h>

#include "geometry/atomic_file.h"

namespace trueblade {
namespace {

class MapWriter final : public YamlFields {
 public:
  explicit MapWriter(YAML::Emitter& out) : out_(out) {}

  bool reading() const override { return false; }
  bool present(std::string_view) override { return true; }
  bool holds_foreign(std::string_view) const override { return false; }
  void require(std::string_view) override {}
  void fail_unless(bool, const std::string&) override {}
  InputError error(std::string_view, const std::string& message) const override {
    return InputError(message);
  }
  InputError error_about(const std::string& message) const override { return InputError(message); }
  std::string place(std::string_view) const override { return ""; }

  void map(std::string_view key, const MapFunction& fields_of_map) override {
    out_ << YAML::Key << std::string(key) << YAML::Value << YAML::BeginMap;
    MapWriter inner(out_);
    fields_of_map(inner);
    out_ << YAML::EndMap;
  }

 protected:
  bool scalar(std::string_view key, std::string& text) override {
    out_ << YAML::Key << std::string(key) << YAML::Value << text;
    return true;
  }

  bool scalars(std::string_view key, std::vector<std::string>& texts) override {
    out_ << YAML::Key << std::string(key) << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const std::string& text : texts) out_ << text;
    out_ << YAML::EndSeq;
    return true;
  }

  void maps(std::string_view key, std::size_t count, const std::function<void(std::size_t)>&,
            const IndexFunction& fields_of_item) override {
    out_ << YAML::Key << std::string(key) << YAML::Value << YAML::BeginSeq;
    for (std::size_t item = 0; item < count; ++item) {
      out_ << YAML::BeginMap;
      MapWriter inner(out_);
      fields_of_item(inner, item);
      out_ << YAML::EndMap;
    }
    out_ << YAML::EndSeq;
  }

  void named_maps(std::string_view key, const std::vector<std::string>& names,
                  const NameFunction& fields_of_item) override {
    map(key, [&](YamlFields& io) {
      for (const std::string& name : names)
        io.map(name, [&](YamlFields& inner) { fields_of_item(inner, name); });
    });
  }

 private:
  YAML::Emitter& out_;
};

}  // namespace

std::string yaml_text(const YamlFields::MapFunction& fields) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  MapWriter writer(out);
  fields(writer);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

void write_yaml(const std::filesystem::path& file, const YamlFields::MapFunction& fields) {
  write_text_atomically(file, yaml_text(fields));
}

}  // namespace trueblade
