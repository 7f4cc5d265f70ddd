#pragma once

#include "planning/constraint/quadratic_program.hpp"

namespace clearway::bench {

/// What `solve` answers, by the plain form of the same method: what QuadraticSolver is measured against.
/// @pre a program that `solve` accepts.
QuadraticSolution solve_densely(const QuadraticProgram& program);

}  // namespace clearway::bench
