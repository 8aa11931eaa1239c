// One description of a struct's keys serves reading and writing.
//
// For each struct that a user writes in YAML there is one function, as in
//
//   void fields(YamlFields& io, ScanSpec& scan) {
//     io.number("spacing_mm", scan.spacing_mm, above(0.0));
//     io.angle("tilt_deg", scan.tilt_rad);
//   }
//
// yaml_reader.h calls it to fill the struct from a file, yaml_writer.h to write the struct: what is written
// reads back to the same struct, because there is only one list of keys. A key that is absent leaves the
// field as it is (the default). Keys carry their unit: _mm, _s, _hz; angles are _deg in the file and rad in
// the struct.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "geometry/rigid_transform.h"
#include "geometry/vector.h"

namespace trueblade {

// What a number must satisfy, and the words that say so.
struct NumberConstraint {
  std::function<bool(double)> holds;
  std::string words;  // follows "must be "
};
NumberConstraint any_number();
NumberConstraint above(double bound);
NumberConstraint at_least(double bound);
NumberConstraint between(double low, double high);  // both included

class YamlFields {
 public:
  using MapFunction = std::function<void(YamlFields&)>;

  virtual ~YamlFields() = default;
  virtual bool reading() const = 0;
  // Reading: whether the key stands in the file. Writing: true.
  virtual bool present(std::string_view key) = 0;
  // Reading: the same for a key of another kind of file, which a message about unknown keys must not offer.
  // Writing: false.
  virtual bool holds_foreign(std::string_view key) const = 0;
  // Reading: an error when the key is absent, reported after misspelt keys. Writing: nothing.
  virtual void require(std::string_view key) = 0;
  // Reading: an error at the end of this map, for what concerns the map as a whole. Writing: nothing.
  virtual void fail_unless(bool holds, const std::string& message) = 0;
  // Reading: an error that names file and line of the key, where it stands, or else of this map. A message
  // that begins with the key gets the way to it in front.
  virtual InputError error(std::string_view key, const std::string& message) const = 0;
  // Reading: the same for a message that speaks of keys in its own words.
  virtual InputError error_about(const std::string& message) const = 0;
  // Reading: "file:line" of the key, where it stands, or else of this map, for what is found out later.
  virtual std::string place(std::string_view key) const = 0;
  // Calls `validate`; an InputError gets the file and line of the first key that its words name (a key of an
  // inner map as "map.key"; _rad stands for _deg), or else of this map.
  void check(const std::function<void()>& validate) const;

  void number(std::string_view key, double& value, const NumberConstraint& constraint = any_number());
  void number(std::string_view key, std::optional<double>& value,
              const NumberConstraint& constraint = any_number());
  // `key` ends in _deg; the constraint is on degrees.
  void angle(std::string_view key, double& value_rad, const NumberConstraint& constraint = any_number());
  void angle(std::string_view key, std::optional<double>& value_rad,
             const NumberConstraint& constraint = any_number());
  void integer(std::string_view key, std::uint64_t& value, std::uint64_t least, std::uint64_t most);
  void integer(std::string_view key, std::int64_t& value, std::int64_t least, std::int64_t most);
  void integer(std::string_view key, int& value, int least, int most);
  void integers(std::string_view key, std::vector<std::uint32_t>& values);
  void flag(std::string_view key, bool& value);
  void text(std::string_view key, std::string& value);
  // A file; a relative one is relative to `folder`.
  void path(std::string_view key, std::filesystem::path& file, const std::filesystem::path& folder);
  void vector(std::string_view key, Vec3& value);
  // Three numbers in degrees (key ends in _deg), radians inside.
  void angles(std::string_view key, Vec3& value_rad);
  // [low, high], low <= high.
  void interval(std::string_view key, std::optional<std::pair<double, double>>& value);
  void texts(std::string_view key, std::vector<std::string>& values);
  void numbers(std::string_view key, std::vector<double>& values);
  // {rotation_wxyz: [w, x, y, z], translation_mm: [x, y, z]}
  void pose(std::string_view key, RigidTransform& target_from_source);

  template <class Enum>
  void choice(std::string_view key, Enum& value,
              std::span<const std::pair<std::string_view, Enum>> names_of_values);

  template <class Enum>
  void choice(std::string_view key, std::optional<Enum>& value,
              std::span<const std::pair<std::string_view, Enum>> names_of_values);

  virtual void map(std::string_view key, const MapFunction& fields_of_map) = 0;
  template <class Value>
  void optional_map(std::string_view key, std::optional<Value>& value,
                    const std::function<void(YamlFields&, Value&)>& fields_of_value);
  template <class Value>
  void list(std::string_view key, std::vector<Value>& values,
            const std::function<void(YamlFields&, Value&)>& fields_of_value);
  // A map from names that the user chooses.
  template <class Value>
  void named(std::string_view key, std::map<std::string, Value>& values,
             const std::function<void(YamlFields&, Value&)>& fields_of_value);

 protected:
  using IndexFunction = std::function<void(YamlFields&, std::size_t)>;
  using NameFunction = std::function<void(YamlFields&, const std::string&)>;

  // Reading: fills `text` and returns true when the key is present. Writing: writes it, returns true.
  virtual bool scalar(std::string_view key, std::string& text) = 0;
  virtual bool scalars(std::string_view key, std::vector<std::string>& texts) = 0;
  // A list of maps. Reading: `resize` is told the length first. Writing: `count` maps.
  virtual void maps(std::string_view key, std::size_t count, const std::function<void(std::size_t)>& resize,
                    const IndexFunction& fields_of_item) = 0;
  // A map of maps. Reading: every key of the file in order. Writing: the names given.
  virtual void named_maps(std::string_view key, const std::vector<std::string>& names,
                          const NameFunction& fields_of_item) = 0;

 private:
  template <class Integer>
  void whole_number(std::string_view key, Integer& value, Integer least, Integer most);
  double parse(std::string_view key, const std::string& text, const NumberConstraint& constraint) const;
  bool numbers(std::string_view key, std::span<double> values);
  [[noreturn]] void fail_choice(std::string_view key, const std::string& text,
                                const std::vector<std::string>& valid) const;
};

// A number written with a decimal comma, with its point: 0,5 is 0.5. No value for any other text.
std::optional<std::string> with_decimal_point(const std::string& text);
// The shortest text that reads back to the same number.
std::string number_text(double value);
// Degrees whose reading gives the same radians, bit by bit, where such a number exists.
std::string degrees_text(double radians);
double radians_from_degrees(double degrees);

// ---------------------------------------------------------------------------------------------------------

template <class Enum>
void YamlFields::choice(std::string_view key, Enum& value,
                        std::span<const std::pair<std::string_view, Enum>> names_of_values) {
  std::string text;
  std::vector<std::string> valid;
  for (const auto& [name, named_value] : names_of_values) {
    valid.emplace_back(name);
    if (named_value == value) text = name;
  }
  if (!scalar(key, text)) return;
  for (const auto& [name, named_value] : names_of_values)
    if (name == text) {
      value = named_value;
      return;
    }
  fail_choice(key, text, valid);
}

template <class Enum>
void YamlFields::choice(std::string_view key, std::optional<Enum>& value,
                        std::span<const std::pair<std::string_view, Enum>> names_of_values) {
  if (reading() && present(key)) value.emplace();
  if (value) choice(key, *value, names_of_values);
}

template <class Value>
void YamlFields::optional_map(std::string_view key, std::optional<Value>& value,
                              const std::function<void(YamlFields&, Value&)>& fields_of_value) {
  if (reading() && present(key)) value.emplace();
  if (value) map(key, [&](YamlFields& io) { fields_of_value(io, *value); });
}

template <class Value>
void YamlFields::list(std::string_view key, std::vector<Value>& values,
                      const std::function<void(YamlFields&, Value&)>& fields_of_value) {
  maps(
      key, values.size(), [&](std::size_t count) { values.assign(count, Value{}); },
      [&](YamlFields& io, std::size_t item) { fields_of_value(io, values[item]); });
}

template <class Value>
void YamlFields::named(std::string_view key, std::map<std::string, Value>& values,
                       const std::function<void(YamlFields&, Value&)>& fields_of_value) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  named_maps(key, names, [&](YamlFields& io, const std::string& name) { fields_of_value(io, values[name]); });
}

}  // namespace trueblade
