#pragma once

#include "datasets/descriptions/suite.hpp"

namespace clearway {

class YamlFields;

// What a suite may ask for: about a gigabyte for a world, as much for results. Measured: a point on a solid
// takes some 40 bytes while sensors look, a ray or a painted voxel of a surface some 60.

/// Refuses a made world by the extents of its solids, its sensors' range and its paint against its
/// resolution.
/// @throws std::invalid_argument naming the field, what it asks for and the limit.
void require_size(const YamlFields& fields, const SuiteWorld& world);

/// Refuses more than a million runs, or teams that take more than 200,000 steps.
void require_size(const YamlFields& fields, const SuiteExperiment& experiment);

}  // namespace clearway
