// Sections of the blade: mean line and thickness against the closed form of an ellipse, and the numbers that
// a section is asked for against the outline that comes out.
#include "part/blade_section.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "geometry/error.h"

namespace trueblade {
namespace {

constexpr double kPi = std::numbers::pi;

// Half-axes 0.5 and `b`, Selig's order.
AirfoilSection ellipse(double b) {
  AirfoilSection section{"ellipse", {}};
  constexpr int kPoints = 400;
  for (int i = 0; i <= kPoints; ++i)
    section.outline.emplace_back(0.5 + 0.5 * std::cos(2.0 * kPi * i / kPoints),
                                 b * std::sin(2.0 * kPi * i / kPoints));
  return section;
}

TEST(MeanLine, OfAnEllipseIsItsAxisWithTheRadiusOfTheClosedForm) {
  const double a = 0.5, b = 0.1;
  const MeanLine mean_line(ellipse(b));
  EXPECT_NEAR(mean_line.at(mean_line.x_of_largest_radius()).radius, b, 1e-6);
  for (const double x : {0.05, 0.1, 0.3, 0.5, 0.62, 0.9, 0.95}) {
    const MeanLine::Circle circle = mean_line.at(x);
    const double c2 = a * a - b * b, from_middle = x - 0.5;
    const double radius = b * std::sqrt(1.0 - from_middle * from_middle / c2);
    // The outline is a cubic spline through points h = 0.0079 apart or closer, of curvature up to a / b^2 =
    // 50 at the nose: 5/384 h^4 (50^3) = 6e-6 there and far less elsewhere.
    EXPECT_NEAR(circle.centre.y(), 0.0, 6e-6) << x;
    EXPECT_NEAR(circle.radius, radius, 6e-6) << x;
    // Slopes lose one order of h over the 0.01 to 0.02 between circles.
    EXPECT_NEAR(circle.radius_by_x, -b * b * from_middle / (c2 * radius), 1e-3) << x;
  }
}

TEST(MeanLine, RefusesAnOutlineWithoutThickness) {
  AirfoilSection flat{"flat", {}};
  for (int i = -10; i <= 10; ++i) flat.outline.emplace_back(std::abs(i) / 10.0, 0.0);
  EXPECT_THROW(MeanLine{flat}, InputError);
}

class Section : public testing::Test {
 protected:
  const MeanLine mean_line_{naca_65_section(1.2)};
  const SectionSize size_{36.0, 3.6, 0.45, 0.35, 0.8, 14.0 * kPi / 180.0};
  const BladeSection section_{mean_line_, size_, "root"};

  std::vector<Vec2> outline(int per_piece) const {
    std::vector<Vec2> points;
    for (const SectionPiece piece : kSectionPieces)
      for (int i = 0; i < per_piece; ++i)
        points.push_back(section_.point(piece, static_cast<double>(i) / per_piece));
    return points;
  }
};

// Centre of the circle through three points.
Vec2 circumcentre(const Vec2& a, const Vec2& b, const Vec2& c) {
  Eigen::Matrix2d rows;
  rows << (b - a).transpose(), (c - a).transpose();
  const Vec2 right(0.5 * (b.squaredNorm() - a.squaredNorm()), 0.5 * (c.squaredNorm() - a.squaredNorm()));
  return rows.inverse() * right;
}

TEST_F(Section, EdgesAreArcsOfTheStatedRadiiOnTheStaggeredChordLine) {
  const auto centre_of = [&](SectionPiece first, SectionPiece second, double radius) {
    const Vec2 centre =
        circumcentre(section_.point(first, 0.0), section_.point(first, 1.0), section_.point(second, 0.4));
    for (const double along :
         {0.0, 0.3, 0.7, 1.0}) {  // rounding of coordinates of 20 mm: 1e-12 with its condition
      EXPECT_NEAR((section_.point(first, along) - centre).norm(), radius, 1e-11);
      EXPECT_NEAR((section_.point(second, along) - centre).norm(), radius, 1e-11);
    }
    return centre;
  };
  const Vec2 leading = centre_of(SectionPiece::leading_pressure, SectionPiece::leading_suction, 0.45);
  const Vec2 trailing = centre_of(SectionPiece::trailing_suction, SectionPiece::trailing_pressure, 0.35);
  const Vec2 chord_line = trailing - leading;
  EXPECT_NEAR(chord_line.norm() + 0.45 + 0.35, 36.0, 1e-10);
  EXPECT_NEAR(std::atan2(chord_line.y(), chord_line.x()), size_.stagger_rad, 1e-11);
}

TEST_F(Section, ExtendsOneChordAlongTheChordLine) {
  const Vec2 along(std::cos(size_.stagger_rad), std::sin(size_.stagger_rad));
  double low = 0.0, high = 0.0;
  for (const Vec2& point : outline(2000)) {
    low = std::min(low, point.dot(along));
    high = std::max(high, point.dot(along));
  }
  // Points on the arcs lie at most 0.001 rad from the extreme one: r * 0.001^2 / 2 = 2e-7.
  EXPECT_NEAR(high - low, 36.0, 1e-6);
}

// Brute force over the outline: the circle that touches the suction side at p from inside and passes through
// q has the radius |q - p|^2 / (2 n (q - p)); the inscribed one is the least over all q.
TEST_F(Section, LargestInscribedCircleHasTheStatedThickness) {
  const std::vector<Vec2> points = outline(2000);
  double largest = 0.0;
  for (int i = 1; i < 200; ++i) {
    const Vec2 point = section_.point(SectionPiece::suction, i / 200.0);
    const Vec2 tangent = section_.unit_tangent(SectionPiece::suction, i / 200.0);
    const Vec2 inward(tangent.y(), -tangent.x());
    double radius = 1e9;
    for (const Vec2& other : points)
      if (const double depth = 2.0 * inward.dot(other - point); depth > 1e-3)
        radius = std::min(radius, (other - point).squaredNorm() / depth);
    largest = std::max(largest, radius);
  }
  // Points 0.25 mm apart where the radius falls off by 0.25^2 / 8 * 2 * 1.8 / 12^2 = 2e-4 (a parabola that
  // falls to half the thickness 12 mm away).
  EXPECT_NEAR(2.0 * largest, 3.6, 5e-4);
}

TEST_F(Section, PiecesJoinWithoutGapOrKink) {
  for (std::size_t i = 0; i < kSectionPieces.size(); ++i) {
    const SectionPiece piece = kSectionPieces[i], next = kSectionPieces[(i + 1) % kSectionPieces.size()];
    EXPECT_LT((section_.point(piece, 1.0) - section_.point(next, 0.0)).norm(), 1e-12);  // rounding at 20 mm
    EXPECT_LT((section_.unit_tangent(piece, 1.0) - section_.unit_tangent(next, 0.0)).norm(), 1e-12);
  }
}

TEST_F(Section, TangentIsTheDerivative) {
  for (const SectionPiece piece : kSectionPieces)
    for (const double along : {0.2, 0.5, 0.8}) {
      const double h = 1e-5;
      const Vec2 difference = section_.point(piece, along + h) - section_.point(piece, along - h);
      // Rounding of 20 mm coordinates over steps of 1e-5 of at least 0.3 mm: 4e-15 / 3e-6 = 1e-9.
      EXPECT_LT((difference.normalized() - section_.unit_tangent(piece, along)).norm(), 1e-7);
    }
}

TEST_F(Section, CentroidIsOnTheStackingAxis) {
  double twice_area = 0.0;
  Vec2 moment = Vec2::Zero();
  const std::vector<Vec2> points = outline(3000);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 &a = points[i], &b = points[(i + 1) % points.size()];
    const double cross = a.x() * b.y() - a.y() * b.x();
    twice_area += cross;
    moment += cross * (a + b);
  }
  EXPECT_LT(twice_area, 0.0);  // clockwise
  // The section places itself by 200 points per piece: 0.2 mm chords with a sagitta of 1e-4 mm.
  EXPECT_LT((moment / (3.0 * twice_area)).norm(), 1e-3);
}

TEST_F(Section, SuctionSideIsAtPositiveYAndTheLeadingEdgeAtNegativeX) {
  EXPECT_GT(section_.point(SectionPiece::suction, 0.5).y(),
            section_.point(SectionPiece::pressure, 0.5).y() + 3.0);
  EXPECT_LT(section_.point(SectionPiece::leading_suction, 0.0).x(), -15.0);
}

TEST_F(Section, RefusesEdgeRadiiThatDoNotFit) {
  const auto message = [&](double SectionSize::*field, double value) {
    SectionSize size = size_;
    size.*field = value;
    try {
      BladeSection(mean_line_, size, "tip");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(message(&SectionSize::leading_edge_radius_mm, 0.1).find("tip_leading_edge_radius_mm is 0.1"),
            std::string::npos);
  EXPECT_NE(message(&SectionSize::leading_edge_radius_mm, 1.9).find("tip_leading_edge_radius_mm is 1.9"),
            std::string::npos);
  EXPECT_NE(message(&SectionSize::trailing_edge_radius_mm, 1.9).find("tip_trailing_edge_radius_mm is 1.9"),
            std::string::npos);
}

}  // namespace
}  // namespace trueblade
