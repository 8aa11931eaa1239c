// The part of the parameter plane that a trimmed face keeps: the inside of its border loops, as polygons.
#pragma once

#include <vector>

#include "geometry/vector.h"

namespace trueblade {

// Even-odd inside test in O(segments near the query's v): segments are binned by v. Immutable; const calls
// may run from any number of threads.
class TrimmedRegion {
 public:
  struct Segment {
    Vec2 from, to;
  };

  TrimmedRegion() = default;
  explicit TrimmedRegion(const std::vector<Segment>& border);

  bool contains(const Vec2& uv) const;
  const Vec2& lower() const { return lower_; }  // bounding box of the border
  const Vec2& upper() const { return upper_; }

 private:
  Vec2 lower_ = Vec2::Zero(), upper_ = Vec2::Zero();
  double bands_per_v_ = 0.0;
  std::vector<std::vector<Segment>> bands_;

  std::size_t band_of(double v) const;
};

}  // namespace trueblade
