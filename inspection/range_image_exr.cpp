#include "inspection/range_image_exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <locale>
#include <sstream>

#include "geometry/atomic_file.h"
#include "geometry/error.h"

namespace trueblade {
namespace {

// Deflate, which our files use, makes at most 1032 bytes out of one (RFC 1951: 258 bytes from 2 bits).
constexpr std::uint64_t kLargestExpansion = 1032;

constexpr char kPoseText[] = "part_from_mcs_wxyz_mm";

Imath::M44d row_vector_matrix(const RigidTransform& pose) {
  const Mat3 r = pose.rotation.toRotationMatrix();
  Imath::M44d m;  // identity
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m[column][row] = r(row, column);
    m[3][row] = pose.translation_mm[row];
  }
  return m;
}

std::string pose_text(const RigidTransform& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Vec3& t = pose.translation_mm;
  // "{}" prints the shortest text that reads back as the same double.
  return fmt::format("{} {} {} {} {} {} {}", q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
}

RigidTransform parse_pose(const std::string& file, const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double v[7];
  for (double& value : v) stream >> value;
  if (!stream)
    throw file_error(file, fmt::format("attribute {} is '{}', must hold 7 numbers", kPoseText, text));
  return {Eigen::Quaterniond(v[0], v[1], v[2], v[3]), Vec3(v[4], v[5], v[6])};
}

Imf::Header header_of(const RangeImage& image) {
  Imf::Header header(static_cast<int>(image.columns), static_cast<int>(image.rows));
  header.compression() = Imf::ZIP_COMPRESSION;
  const auto text = [&](const char* name, const std::string& value) {
    header.insert(name, Imf::StringAttribute(value));
  };
  text("units", "mm; incidence: rad");
  text("frames", "x y z normal: pcs; range: along the beam");
  text("view", image.view);
  text("program", image.program_version);
  text("scenario", image.scenario);
  text("seed", std::to_string(image.seed));
  text(kPoseText, pose_text(image.part_from_mcs));
  header.insert("part_from_mcs", Imf::M44dAttribute(row_vector_matrix(image.part_from_mcs)));
  for (const RangeChannel& channel : image.channels) {
    header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
  }
  return header;
}

Imf::Slice slice_of(const std::vector<float>& values, std::size_t columns) {
  // OpenEXR takes one pointer type for reading and writing; writing leaves the pixels alone.
  char* base = const_cast<char*>(reinterpret_cast<const char*>(values.data()));
  return {Imf::FLOAT, base, sizeof(float), sizeof(float) * columns};
}

std::string text_attribute(const std::string& file, const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
  if (!attribute)
    throw file_error(file, fmt::format("attribute {} is missing; not a trueblade range image", name));
  return attribute->value();
}

std::uint64_t parse_seed(const std::string& file, const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw file_error(file, fmt::format("attribute seed is '{}', must be a whole number of 64 bits", text));
  }
  return seed;
}

// Before anything of the stated size is allocated.
void check_size(const std::string& file, const Imf::Header& header, std::uint64_t cells,
                std::uint64_t channels) {
  if (header.compression() != Imf::ZIP_COMPRESSION) {
    throw file_error(file, "compression is not ZIP; not a trueblade range image");
  }
  const std::uint64_t bytes = cells * channels * sizeof(float);
  const std::uint64_t file_bytes = std::filesystem::file_size(file);
  if (bytes > kLargestExpansion * file_bytes) {
    throw file_error(file, fmt::format("states {} cells of {} channels, more than its {} bytes can hold",
                                       cells, channels, file_bytes));
  }
}

RangeImage read(const std::string& file) {
  Imf::InputFile input(file.c_str());
  const Imf::Header& header = input.header();
  if (!input.isComplete()) throw file_error(file, "is truncated");

  RangeImage image;
  const Imath::Box2i window = header.dataWindow();
  if (window.min != Imath::V2i(0, 0)) {
    throw file_error(file, "data window does not start at 0; not a trueblade range image");
  }
  image.columns = static_cast<std::size_t>(window.max.x) + 1;
  image.rows = static_cast<std::size_t>(window.max.y) + 1;
  image.view = text_attribute(file, header, "view");
  image.scenario = text_attribute(file, header, "scenario");
  image.program_version = text_attribute(file, header, "program");
  image.seed = parse_seed(file, text_attribute(file, header, "seed"));
  image.part_from_mcs = parse_pose(file, text_attribute(file, header, kPoseText));

  std::uint64_t channels = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel, ++channels) {
    if (channel.channel().type != Imf::FLOAT || channel.channel().xSampling != 1 ||
        channel.channel().ySampling != 1) {
      throw file_error(file, fmt::format("channel {} is not float32 at full resolution", channel.name()));
    }
  }
  const std::uint64_t cells = image.columns * image.rows;  // each below 2^31
  check_size(file, header, cells, channels);

  image.channels.reserve(channels);
  Imf::FrameBuffer frame;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    image.channels.push_back({channel.name(), std::vector<float>(cells)});
    frame.insert(channel.name(), slice_of(image.channels.back().values, image.columns));
  }
  input.setFrameBuffer(frame);
  input.readPixels(0, static_cast<int>(image.rows) - 1);
  return image;
}

}  // namespace

void write_range_image_exr(const std::filesystem::path& file, const RangeImage& image) {
  if (image.columns == 0 || image.rows == 0) {
    throw file_error(file.string(), fmt::format("range image of view '{}' has no cell", image.view));
  }
  write_path_atomically(file, [&](const std::filesystem::path& temporary) {
    try {
      Imf::OutputFile output(temporary.c_str(), header_of(image));
      Imf::FrameBuffer frame;
      for (const RangeChannel& channel : image.channels) {
        frame.insert(channel.name, slice_of(channel.values, image.columns));
      }
      output.setFrameBuffer(frame);
      output.writePixels(static_cast<int>(image.rows));
    } catch (const Iex::BaseExc& error) {
      throw file_error(file.string(), std::string("cannot be written: ") + error.what());
    }
  });
}

RangeImage read_range_image_exr(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file))
    throw file_error(file.string(), "is missing or no regular file");
  try {
    return read(file.string());
  } catch (const Iex::BaseExc& error) {
    throw file_error(file.string(), std::string("is no readable OpenEXR file: ") + error.what());
  }
}

}  // namespace trueblade
