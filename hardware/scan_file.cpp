#include "hardware/scan_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>

#include "geometry/atomic_file.h"
#include "geometry/error.h"

namespace trueblade {
namespace {

static_assert(std::endian::native == std::endian::little, "the columns are copied as they lie in memory");

constexpr const char* kSampleColumns =
    "property double snr\n"
    "property double x_axis\nproperty double y_axis\nproperty double z_axis\nproperty double theta\n"
    "property double distance\nproperty double time\n"
    "property uchar flags\nproperty uint cell\nproperty uint sample\n";
constexpr const char* kVertexColumns =
    "property double x\nproperty double y\nproperty double z\nproperty float quality\n";

constexpr std::size_t kSampleBytes = 7 * sizeof(double) + 1 + 2 * sizeof(std::uint32_t);
constexpr std::size_t kVertexBytes = 3 * sizeof(double) + sizeof(float) + kSampleBytes;

template <class Value>
void put(std::string& out, Value value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class Value>
Value take(const char*& in) {
  Value value;
  std::memcpy(&value, in, sizeof value);
  in += sizeof value;
  return value;
}

void put_sample(std::string& out, const ProbeSample& s, std::uint32_t cell, std::uint32_t number) {
  for (const double value :
       {s.snr, s.axes.x_mm, s.axes.y_mm, s.axes.z_mm, s.axes.theta_rad, s.distance_mm, s.time_s})
    put(out, value);
  put(out, s.flags.bits());
  put(out, cell);
  put(out, number);
}

struct NumberedSample {
  ProbeSample sample;
  std::uint32_t cell, number;
};

NumberedSample take_sample(const char*& in) {
  NumberedSample s;
  for (double* value : {&s.sample.snr, &s.sample.axes.x_mm, &s.sample.axes.y_mm, &s.sample.axes.z_mm,
                        &s.sample.axes.theta_rad, &s.sample.distance_mm, &s.sample.time_s})
    *value = take<double>(in);
  s.sample.flags = ProbeFlags::from_bits(take<std::uint8_t>(in));
  s.cell = take<std::uint32_t>(in);
  s.number = take<std::uint32_t>(in);
  return s;
}

// The header is a function of the scan. The reader rebuilds it from the values it found and compares, so that
// a file with other columns is refused instead of misread.
std::string header_of(const ViewScan& scan, std::size_t usable, std::size_t lost) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\n"
      "comment trueblade scan 1\ncomment unit mm\ncomment frame mcs\n"
      "comment view {}\ncomment theta_rad {}\ncomment columns {}\ncomment rows {}\n"
      "comment time_s {}\ncomment complete {}\n"
      "element vertex {}\n{}{}element lost_sample {}\n{}end_header\n",
      scan.view, scan.theta_rad, scan.columns, scan.rows, scan.time_s, scan.complete ? 1 : 0, usable,
      kVertexColumns, kSampleColumns, lost, kSampleColumns);
}

template <class Value>
Value parse_number(const std::string& file, const std::map<std::string, std::string>& values,
                   const std::string& key) {
  const auto found = values.find(key);
  if (found == values.end())
    throw file_error(file, "not a trueblade scan: the header has no \"" + key + "\"");
  const std::string& text = found->second;
  Value value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw file_error(file, fmt::format("header: {} is \"{}\", must be a number", key, text));
  return value;
}

struct ScanHeader {
  ViewScan scan;  // without samples
  std::size_t usable, lost, bytes;
};

ScanHeader parse_header(const std::string& file, const std::string& content) {
  static constexpr std::string_view kEnd = "end_header\n";
  const std::size_t end = content.find(kEnd);
  if (!content.starts_with("ply\n") || end == std::string::npos) throw file_error(file, "not a PLY file");

  // "comment key value" and "element name count"; other lines are compared as a whole below.
  std::map<std::string, std::string> values;
  std::istringstream lines(content.substr(0, end));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(' ');
    const std::size_t second = line.find(' ', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string word = line.substr(0, first);
    if (word == "comment" || word == "element")
      values.emplace(line.substr(first + 1, second - first - 1), line.substr(second + 1));
  }

  ScanHeader header;
  header.bytes = end + kEnd.size();
  header.scan.view = values["view"];
  header.scan.theta_rad = parse_number<double>(file, values, "theta_rad");
  header.scan.columns = parse_number<std::size_t>(file, values, "columns");
  header.scan.rows = parse_number<std::size_t>(file, values, "rows");
  header.scan.time_s = parse_number<double>(file, values, "time_s");
  header.scan.complete = parse_number<int>(file, values, "complete") != 0;
  header.usable = parse_number<std::size_t>(file, values, "vertex");
  header.lost = parse_number<std::size_t>(file, values, "lost_sample");
  if (content.compare(0, header.bytes, header_of(header.scan, header.usable, header.lost)) != 0)
    throw file_error(file, "not a trueblade scan: the header has other columns than version 1");
  return header;
}

}  // namespace

void write_scan(const std::filesystem::path& file, const ViewScan& scan) {
  if (scan.view.find_first_of("\r\n") != std::string::npos)
    throw InputError("the name of a view must be a single line");
  std::string vertices, lost_samples;
  vertices.reserve(scan.usable.size() * kVertexBytes);
  std::size_t next_usable = 0;
  for (std::uint32_t i = 0; i < scan.samples.size(); ++i) {
    const bool usable = next_usable < scan.usable.size() && scan.usable[next_usable] == i;
    if (usable) {
      const Vec3& p = scan.points.position_mcs_mm[next_usable++];
      put(vertices, p.x());
      put(vertices, p.y());
      put(vertices, p.z());
      put(vertices, static_cast<float>(scan.samples[i].snr));
    }
    put_sample(usable ? vertices : lost_samples, scan.samples[i], scan.grid_index[i], i);
  }
  write_file_atomically(file, [&](std::ostream& out) {
    out << header_of(scan, scan.usable.size(), scan.samples.size() - scan.usable.size());
    out << vertices << lost_samples;
  });
}

ViewScan read_scan(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw file_error(file.string(), "cannot be read");
  const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  return read_scan_bytes(bytes, file.string());
}

ViewScan read_scan_bytes(const std::string& bytes, const std::string& name) {
  const ScanHeader header = parse_header(name, bytes);
  // The counts are bounded by the file's own length before anything is allocated or multiplied.
  const std::size_t body = bytes.size() - header.bytes;
  const bool counts_fit = header.usable <= body / kVertexBytes && header.lost <= body / kSampleBytes;
  if (!counts_fit || header.usable * kVertexBytes + header.lost * kSampleBytes != body)
    throw file_error(name,
                     fmt::format("holds {} bytes of samples, which is not what its header says ({} usable, "
                                 "{} lost): truncated or damaged",
                                 body, header.usable, header.lost));

  ViewScan scan = header.scan;
  const std::size_t count = header.usable + header.lost;
  scan.samples.resize(count);
  scan.grid_index.resize(count);
  std::vector<char> seen(count, false);
  const auto place = [&](const NumberedSample& s) {
    if (s.number >= count || seen[s.number])
      throw file_error(name, fmt::format("sample number {} is repeated or above {}", s.number, count - 1));
    if (s.cell / std::max<std::size_t>(scan.columns, 1) >= scan.rows)
      throw file_error(name, fmt::format("sample {}: cell {} lies outside the grid of {} x {}", s.number,
                                         s.cell, scan.columns, scan.rows));
    seen[s.number] = true;
    scan.samples[s.number] = s.sample;
    scan.grid_index[s.number] = s.cell;
  };

  const char* in = bytes.data() + header.bytes;
  for (std::size_t i = 0; i < header.usable; ++i) {
    const double x = take<double>(in);
    const double y = take<double>(in);
    const double z = take<double>(in);
    in += sizeof(float);  // quality repeats snr
    const NumberedSample s = take_sample(in);
    if (!Vec3(x, y, z).allFinite())
      throw file_error(name, fmt::format("sample {}: the point is not finite", s.number));
    if (!scan.usable.empty() && s.number <= scan.usable.back())
      throw file_error(name, fmt::format("sample number {} is out of order", s.number));
    place(s);
    scan.usable.push_back(s.number);
    scan.points.position_mcs_mm.emplace_back(x, y, z);
    scan.points.snr.push_back(s.sample.snr);
  }
  for (std::size_t i = 0; i < header.lost; ++i) place(take_sample(in));
  return scan;
}

}  // namespace trueblade
