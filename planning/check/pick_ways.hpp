#pragma once

// Private to check_pick: what is proved between waypoints, by conservative advancement over KDL's kinematics.

#include "planning/check/pick_terms.hpp"

namespace clearway::check {

/// The load, as it is held, keeps to the straight way of a leg. @throws PickRefusal
void require_no_bow(const PickTerms& terms, PickTerms::Leg index, const Eigen::Vector3d& way,
                    const MotionTubes& curve);

/// How low and high the load comes where it may touch what it stands on. @throws PickRefusal
void require_heights(const PickTerms& terms, const Robot& carrying, const Eigen::Isometry3d& map_from_object,
                     PickTerms::Leg index, const MotionTubes& curve);

}  // namespace clearway::check
