// One section of a blade: the envelope of the circles on its mean line, closed by the first and the last of
// them as leading and trailing edge arcs, which are tangent to both sides by construction. For the sources of
// part/ that include OpenCASCADE.
#pragma once

#include <array>

#include "geometry/vector.h"
#include "part/mean_line.h"

namespace trueblade {

struct SectionSize {
  double chord_mm;          // from nose to tail along the chord line, which joins the centres of both arcs
  double max_thickness_mm;  // diameter of the largest inscribed circle
  double leading_edge_radius_mm;
  double trailing_edge_radius_mm;
  double camber_factor;  // on the height of the section's own mean line
  double stagger_rad;    // of the chord line against x, about +z
};

// The section clockwise seen from +z, from the nose over the suction side; each arc is halved at its middle.
enum class SectionPiece {
  leading_suction,
  suction,
  trailing_suction,
  trailing_pressure,
  pressure,
  leading_pressure
};
inline constexpr std::array kSectionPieces = {SectionPiece::leading_suction,  SectionPiece::suction,
                                              SectionPiece::trailing_suction, SectionPiece::trailing_pressure,
                                              SectionPiece::pressure,         SectionPiece::leading_pressure};

class BladeSection {
 public:
  // Throws InputError naming the radius and its constraint when an edge radius does not fit the section.
  // `where` names the section in that message ("root").
  BladeSection(const MeanLine& mean_line, const SectionSize& size, const std::string& where);

  // Point in mm, chord near x, leading edge at negative x, suction side at positive y, centroid in the
  // origin; `along` runs from 0 to 1 clockwise.
  Vec2 point(SectionPiece piece, double along) const {
    return placed_rotation_ * raw_point(piece, along) + placed_shift_;
  }
  Vec2 unit_tangent(SectionPiece piece, double along) const;

 private:
  // Circle on the mean line in mm, before the section is placed.
  struct Disc {
    Vec2 centre;
    double radius;
    Vec2 forward;             // unit tangent of the mean line, towards the tail
    double radius_by_length;  // along the mean line
  };
  Disc disc_at(double x) const;
  Vec2 normal_on(const Disc& disc, double side) const;
  double find_leading_x(const std::string& where) const;
  double find_trailing_x(const std::string& where) const;
  void require_room_for_arcs(const std::string& where) const;
  double x_along_side(double along) const;
  Vec2 raw_normal(SectionPiece piece, double along) const;
  Vec2 raw_point(SectionPiece piece, double along) const;
  void place();

  const MeanLine* mean_line_;
  SectionSize size_;
  double thickness_scale_, length_scale_ = 1.0;
  double leading_x_, trailing_x_;
  Eigen::Matrix2d placed_rotation_ = Eigen::Matrix2d::Identity();
  Vec2 placed_shift_ = Vec2::Zero();
};

}  // namespace trueblade
