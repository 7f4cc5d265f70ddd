#include "tests/evidence/random_arm.hpp"

#include <sstream>

namespace clearway::evidence {
namespace {

std::string numbers(const Eigen::Vector3d& v) {
  std::ostringstream text;
  text.precision(17);
  text << v.x() << ' ' << v.y() << ' ' << v.z();
  return text.str();
}

std::string number(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

/// A link with one body that reaches `length` along z.
std::string link(Random& random, const std::string& name, double length) {
  const double thick = random.between(0.02, 0.05);
  std::string shape;
  switch (random.below(3)) {
    case 0:
      shape = "<box size=\"" + numbers({thick, random.between(0.03, 0.08), length}) + "\"/>";
      break;
    case 1:
      shape = "<cylinder radius=\"" + number(thick) + "\" length=\"" + number(length) + "\"/>";
      break;
    default:
      shape = "<sphere radius=\"" + number(std::max(thick, 0.4 * length)) + "\"/>";
  }
  return "<link name=\"" + name + "\"><collision><origin xyz=\"" + numbers({0.0, 0.0, 0.5 * length}) +
         "\" rpy=\"" + numbers(random.point(0.2)) + "\"/><geometry>" + shape +
         "</geometry></collision></link>\n";
}

std::string joint(Random& random, int index, const std::string& parent, const std::string& child,
                  double parent_length) {
  const int kind = random.below(6);  // one in six slides, one in six turns without end
  const std::string type = kind == 0 ? "prismatic" : kind == 1 ? "continuous" : "revolute";
  const double range = kind == 0 ? random.between(0.05, 0.3) : random.between(1.0, 3.0);
  Eigen::Vector3d axis = random.point(1.0);
  if (random.below(2) == 0) axis = Eigen::Vector3d::Unit(random.below(3));
  if (axis.norm() < 0.1) axis.x() += 1.0;
  std::string text = "<joint name=\"joint" + std::to_string(index) + "\" type=\"" + type +
                     "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/><origin xyz=\"" +
                     numbers({0.0, 0.0, parent_length + 0.06}) + "\" rpy=\"" + numbers(random.point(0.5)) +
                     "\"/><axis xyz=\"" + numbers(axis.normalized()) + "\"/>";
  if (type != "continuous") {
    text += "<limit lower=\"" + number(-range * random.between(0.2, 1.0)) + "\" upper=\"" + number(range) +
            "\" effort=\"10\" velocity=\"1\"/>";
  } else {
    text += "<limit effort=\"10\" velocity=\"1\"/>";
  }
  return text + "</joint>\n";
}

/// The joint of a finger that copies the first joint, backwards and shifted; one in two is of another kind: a
/// rack that a turn moves, or a knuckle that a slide turns.
std::string copy_of_first(Random& random, bool first_slides, const std::string& parent,
                          double parent_length) {
  const bool is_other = random.below(2) == 0, slides = first_slides != is_other;
  const double factor = !is_other ? random.between(0.2, 1.5)
                        : slides  ? random.between(0.02, 0.15)
                                  : random.between(1.0, 6.0);
  const double most = slides && is_other ? 0.4 : 10.0, shift = slides && is_other ? 0.05 : 0.3;
  return std::string("<joint name=\"copy\" type=\"") + (slides ? "prismatic" : "revolute") +
         "\"><parent link=\"" + parent + "\"/><child link=\"finger\"/><origin xyz=\"" +
         numbers({0.05, 0.0, parent_length + 0.06}) + "\"/><axis xyz=\"0 1 0\"/><limit lower=\"" +
         number(-most) + "\" upper=\"" + number(most) +
         "\" effort=\"1\" velocity=\"1\"/><mimic joint=\"joint0\" multiplier=\"" + number(-factor) +
         "\" offset=\"" + number(random.between(-shift, shift)) + "\"/></joint>\n";
}

}  // namespace

std::string random_arm_urdf(Random& random, int joints) {
  std::string links, chain, parent = "base";
  double length = 0.1;
  links += link(random, parent, length);
  for (int i = 0; i < joints; ++i) {
    const std::string child = "link" + std::to_string(i);
    chain += joint(random, i, parent, child, length);
    length = random.between(0.08, 0.3);
    links += link(random, child, length);
    parent = child;
  }
  if (random.below(2) == 0) {
    const bool slides = chain.find("type=\"prismatic\"") < chain.find("</joint>");
    links += link(random, "finger", 0.05);
    chain += copy_of_first(random, slides, parent, length);
  }
  return "<robot name=\"drawn\">\n" + links + chain + "</robot>\n";
}

}  // namespace clearway::evidence
