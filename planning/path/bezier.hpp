#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace clearway {

/// A polynomial in time in Bezier form: it begins at the first control point, ends at the last, and stays in
/// the hull of all (Farin, Curves and Surfaces for CAGD).
struct Bezier {
  std::vector<Eigen::VectorXd> control;  ///< at least one, all of one size; the degree is one less
  double duration = 0.0;                 ///< seconds, above 0
};

/// Position, velocity and acceleration at an end of a polynomial.
struct BezierEnd {
  const Eigen::VectorXd &position, &velocity, &acceleration;
};

/// The polynomials of degree 1, 3 and 5 with these ends: of both positions; of velocities, too; and of
/// accelerations. Ends have one size, but for what the degree does not ask for.
Bezier linear_between(const Eigen::VectorXd& from, const Eigen::VectorXd& to, double duration);
Bezier cubic_between(const BezierEnd& from, const BezierEnd& to, double duration);
Bezier quintic_between(const BezierEnd& from, const BezierEnd& to, double duration);

/// The same polynomial on the first and the second half of its time (de Casteljau).
std::pair<Bezier, Bezier> halves(const Bezier& curve);

/// Its value after a share of the duration, 0 to 1 (de Casteljau).
Eigen::VectorXd value_at(const Bezier& curve, double share);

/// Its derivative by time; of a constant 0.
Bezier derivative(const Bezier& curve);

/// The greatest value of a component, and where: a share of the duration, 0 to 1.
struct BezierPeak {
  double value = 0.0, share = 0.0;
};

/// The greatest absolute value of component `j`, with its sign. What the curve takes on somewhere, and at
/// most 1e-12 of the largest control value less than the greatest.
BezierPeak peak(const Bezier& curve, Eigen::Index j);

/// The greatest and the least value of component `j`, found in the same way.
BezierPeak highest(const Bezier& curve, Eigen::Index j);
BezierPeak lowest(const Bezier& curve, Eigen::Index j);

}  // namespace clearway
