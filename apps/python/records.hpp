#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "apps/python/arrays.hpp"
#include "apps/python/docstrings.hpp"
#include "mapping/voxels/voxel_state.hpp"
#include "planning/problem/planner.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// What Python sees of a value: arrays for points, configurations and poses, words for enumerations.
template <typename Value>
py::object to_python(const Value& value) {
  return py::cast(value);
}
py::object to_python(VoxelState state);  ///< a member of clearway.VoxelState, an IntEnum
inline py::object to_python(Policy policy) { return py::cast(std::string(to_string(policy))); }
inline py::object to_python(PlanStatus status) { return py::cast(std::string(to_string(status))); }
inline py::object to_python(const Eigen::VectorXd& vector) { return to_array(vector); }
inline py::object to_python(const Eigen::Vector3d& point) { return to_array(point); }
inline py::object to_python(const Eigen::Isometry3d& pose) { return to_array(pose); }
inline py::object to_python(const Eigen::AlignedBox3d& box) { return to_array(box); }

template <typename Value>
py::dict to_dictionary(const std::map<std::string, Value>& values) {
  py::dict dictionary;
  for (const auto& [name, value] : values) dictionary[py::str(name)] = to_python(value);
  return dictionary;
}

/// "Name(field=value, …)" from the names in `_fields`; long arrays as their shapes.
std::string describe_record(py::handle self);
/// The fields as a dictionary.
py::dict dictionary_of(const py::object& self);

/// A struct of results as Python sees it: fields to read, with their comments as docstrings.
template <typename Type>
class Record : public py::class_<Type> {
 public:
  Record(py::handle scope, const char* name, const char* comment = nullptr)
      : py::class_<Type>(scope, name, comment ? comment : doc(name)), name_(name) {
    this->def("__repr__", &describe_record, "The fields and their values.");
    this->def("as_dict", &dictionary_of, "The fields and their values as a dictionary.");
    this->attr("_fields") = fields_;
  }

  template <typename Value>
  Record& field(const char* field, Value Type::*member, const char* comment = nullptr) {
    return computed(
        field, [member](const Type& self) { return to_python(self.*member); }, comment);
  }

  template <typename Function>
  Record& computed(const char* field, Function function, const char* comment = nullptr) {
    const std::string own = name_ + "::" + field;
    this->def_property_readonly(field, function, comment ? comment : doc(own));
    fields_.append(field);
    return *this;
  }

 private:
  std::string name_;
  py::list fields_;
};

}  // namespace clearway
