#include "part/trimmed_region.h"

#include <algorithm>

namespace trueblade {

TrimmedRegion::TrimmedRegion(const std::vector<Segment>& border) {
  if (border.empty()) return;
  lower_ = upper_ = border.front().from;
  for (const Segment& segment : border) {
    lower_ = lower_.cwiseMin(segment.from).cwiseMin(segment.to);
    upper_ = upper_.cwiseMax(segment.from).cwiseMax(segment.to);
  }
  // Two segments cross a band on average when the border is one loop that rises and falls evenly.
  bands_.resize(std::max<std::size_t>(1, border.size() / 2));
  const double height = upper_.y() - lower_.y();
  bands_per_v_ = height > 0.0 ? static_cast<double>(bands_.size()) / height : 0.0;
  for (const Segment& segment : border) {
    const auto [low, high] = std::minmax(segment.from.y(), segment.to.y());
    for (std::size_t band = band_of(low); band <= band_of(high); ++band) bands_[band].push_back(segment);
  }
}

std::size_t TrimmedRegion::band_of(double v) const {
  const double band = (v - lower_.y()) * bands_per_v_;
  return static_cast<std::size_t>(std::clamp(band, 0.0, static_cast<double>(bands_.size() - 1)));
}

bool TrimmedRegion::contains(const Vec2& uv) const {
  // Written so that NaN is outside, too.
  const bool in_box = (uv.array() >= lower_.array()).all() && (uv.array() <= upper_.array()).all();
  if (bands_.empty() || !in_box) return false;
  bool inside = false;
  for (const auto& [from, to] : bands_[band_of(uv.y())]) {
    if ((from.y() > uv.y()) == (to.y() > uv.y())) continue;
    const double crossing_u = from.x() + (uv.y() - from.y()) / (to.y() - from.y()) * (to.x() - from.x());
    if (uv.x() < crossing_u) inside = !inside;
  }
  return inside;
}

}  // namespace trueblade
