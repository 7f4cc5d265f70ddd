#pragma once

#include <Eigen/Core>

// How Eigen's types lie in memory, and who frees what they hold, is part of the public headers. Options such
// as -march=native change it, and with it where a program that was compiled otherwise than this library looks
// for a pose.
#if EIGEN_ARCH_i386_OR_x86_64
static_assert(
    EIGEN_MAX_ALIGN_BYTES == 16 && EIGEN_MAX_STATIC_ALIGN_BYTES == 16 && EIGEN_MALLOC_ALREADY_ALIGNED == 1,
    "clearway was compiled with EIGEN_MAX_ALIGN_BYTES=16 and EIGEN_MALLOC_ALREADY_ALIGNED=1: define both for "
    "all of a program that uses it");
#endif
