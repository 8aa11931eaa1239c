#include "inspection/profile_stretches.h"

#include <algorithm>

namespace trueblade {
namespace {

std::vector<std::uint32_t> surfaces_along(const RegistrationTarget& target, const SectionPlane& plane,
                                          const std::vector<Vec2>& outline_mm) {
  const Vec3 y_direction = plane.normal.cross(plane.x_direction);
  std::vector<Vec3> point_mm;
  for (const Vec2& p : outline_mm)
    point_mm.emplace_back(plane.origin_mm + p.x() * plane.x_direction + p.y() * y_direction);
  std::vector<ClosestPoint> closest(point_mm.size());
  ClosestPointWork work;
  target.tree().query(point_mm, closest, {}, work);
  std::vector<std::uint32_t> surfaces;
  for (const ClosestPoint& nearest : closest) surfaces.push_back(target.model().surface_of(nearest.facet));
  return surfaces;
}

bool covers(const ProfileCallout& callout, std::uint32_t surface) {
  return callout.surfaces.empty() ||
         std::find(callout.surfaces.begin(), callout.surfaces.end(), surface) != callout.surfaces.end();
}

const ProfileCallout* narrowest(const std::vector<ProfileResult>& profiles, std::uint32_t surface) {
  const auto width_mm = [](const ProfileCallout& c) { return c.tolerance.upper_mm - c.tolerance.lower_mm; };
  const ProfileCallout* best = nullptr;
  for (const ProfileResult& profile : profiles)
    if (covers(profile.callout, surface) && (!best || width_mm(profile.callout) < width_mm(*best)))
      best = &profile.callout;
  return best;
}

}  // namespace

std::vector<ProfileStretch> profile_stretches(const RegistrationTarget& target, const SectionPlane& plane,
                                              const std::vector<Vec2>& outline_mm,
                                              const std::vector<ProfileResult>& profiles) {
  std::vector<ProfileStretch> stretches;
  const std::vector<std::uint32_t> surfaces = surfaces_along(target, plane, outline_mm);
  const ProfileCallout* before = nullptr;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const ProfileCallout* here = narrowest(profiles, surfaces[i]);
    if (here && here == before)
      stretches.back().last = i;
    else if (here)
      stretches.push_back({here->name, i, i});
    before = here;
  }
  return stretches;
}

}  // namespace trueblade
