#pragma once

#include <Eigen/Core>

// How Eigen's types lie in memory is part of every public header. Options such as -march=native change it,
// and with it where a program that was compiled otherwise than this library looks for a pose.
static_assert(
    EIGEN_MAX_ALIGN_BYTES == 16 && EIGEN_MAX_STATIC_ALIGN_BYTES == 16,
    "clearway was compiled with EIGEN_MAX_ALIGN_BYTES=16: define that for all of a program that uses it, and "
    "EIGEN_MALLOC_ALREADY_ALIGNED=1. find_package(clearway) does so for each target that links "
    "Eigen3::Eigen.");
