#include "apps/pose_file.h"

#include "apps/yaml_reader.h"
#include "apps/yaml_writer.h"

namespace trueblade {
namespace {

void fields(YamlFields& io, ScanPose& pose) {
  constexpr const char* kTruth = "true_part_from_mcs";
  io.pose("part_from_mcs", pose.part_from_mcs);
  if (io.reading() && io.present(kTruth)) pose.true_part_from_mcs.emplace();
  if (pose.true_part_from_mcs) io.pose(kTruth, *pose.true_part_from_mcs);
}

}  // namespace

ScanPose read_scan_pose(const std::filesystem::path& file) {
  ScanPose pose;
  read_yaml(file, [&](YamlFields& io) { fields(io, pose); });
  return pose;
}

void write_scan_pose(const std::filesystem::path& file, const ScanPose& pose) {
  ScanPose copy = pose;
  write_yaml(file, [&](YamlFields& io) { fields(io, copy); });
}

}  // namespace trueblade
