#include "planning/robot/same_robot.hpp"

#include <algorithm>

namespace clearway {
namespace {

bool is_same_shape(const Shape& a, const Shape& b) {
  return a.kind() == b.kind() && a.radius() == b.radius() && a.length() == b.length() &&
         a.edges() == b.edges() && a.vertices() == b.vertices();
}

bool is_same_joint(const Joint& a, const Joint& b) {
  return a.kind == b.kind && a.axis == b.axis && a.lower == b.lower && a.upper == b.upper;
}

bool is_same_link(const Link& a, const Link& b) {
  return a.parent == b.parent && a.joint == b.joint && a.multiplier == b.multiplier && a.offset == b.offset &&
         a.own_axis == b.own_axis && a.own_kind == b.own_kind && a.is_held == b.is_held &&
         a.parent_from_link.matrix() == b.parent_from_link.matrix();
}

bool is_same_sphere(const Sphere& a, const Sphere& b) { return a.center == b.center && a.radius == b.radius; }

bool is_same_body(const Body& a, const Body& b) {
  return a.part == b.part && a.link == b.link && a.link_from_shape.matrix() == b.link_from_shape.matrix() &&
         is_same_shape(a.shape, b.shape) &&
         std::equal(a.cover.begin(), a.cover.end(), b.cover.begin(), b.cover.end(), is_same_sphere);
}

}  // namespace

bool is_same(const Robot& a, const Robot& b) {
  return std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(), is_same_joint) &&
         std::equal(a.links.begin(), a.links.end(), b.links.begin(), b.links.end(), is_same_link) &&
         std::equal(a.bodies.begin(), a.bodies.end(), b.bodies.begin(), b.bodies.end(), is_same_body) &&
         a.exempt == b.exempt && a.standing == b.standing &&
         a.map_from_base.matrix() == b.map_from_base.matrix();
}

}  // namespace clearway
