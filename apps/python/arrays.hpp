#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cxxabi.h>
#include <unistd.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace clearway {

namespace py = pybind11;

// Arrays that Python hands in are copied once into what our functions take, before the interpreter's lock is
// let go: nobody changes them while we compute. What goes out hands its memory over where it lies in one
// piece. All readings throw std::invalid_argument: what the argument is called, which shape was expected and
// what came.

Eigen::Vector3d point_from(py::handle value, const std::string& name);
std::vector<Eigen::Vector3d> points_from(py::handle value, const std::string& name);
/// Points in single precision: rounded to the nearest where they come as doubles.
std::vector<Eigen::Vector3f> cloud_from(py::handle value, const std::string& name);

Eigen::VectorXd vector_from(py::handle value, const std::string& name, std::size_t size);
/// As many numbers as there are.
std::vector<double> list_from(py::handle value, const std::string& name);
/// One value for each of `count`, where a single number stands for all.
std::vector<double> numbers_from(py::handle value, const std::string& name, std::size_t count);
std::vector<Eigen::VectorXd> vectors_from(py::handle value, const std::string& name, std::size_t columns);
std::size_t dimensions_of(py::handle value, const std::string& name);

/// A 4x4 matrix of a rigid motion: finite, its rotation orthonormal within 1e-6.
Eigen::Isometry3d pose_from(py::handle value, const std::string& name);
std::vector<Eigen::Isometry3d> poses_from(py::handle value, const std::string& name);
/// (low, high), two points.
Eigen::AlignedBox3d box_from(py::handle value, const std::string& name);

py::array to_array(const Eigen::VectorXd& vector);
py::array to_array(const Eigen::Vector3d& vector);
py::array to_array(const Eigen::Isometry3d& pose);                                     ///< (4, 4)
py::array to_array(const std::vector<Eigen::Isometry3d>& poses);                       ///< (n, 4, 4)
py::array to_array(const Eigen::AlignedBox3d& box);                                    ///< (2, 3): low, high
py::array to_array(const std::vector<Eigen::Vector3d>& points);                        ///< (n, 3)
py::array to_array(const std::vector<Eigen::VectorXd>& vectors, std::size_t columns);  ///< (n, columns)
py::array to_array(const std::vector<bool>& flags);

/// An array that owns what was a vector, without a copy.
template <typename Value>
py::array own(std::vector<Value> values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<Value>>(std::move(values));
  Value* data = kept->data();
  py::capsule owner(kept.get(), [](void* vector) { delete static_cast<std::vector<Value>*>(vector); });
  kept.release();
  return py::array_t<Value>(std::move(shape), data, owner);
}

template <typename Value>
py::array own(std::vector<Value> values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return own(std::move(values), {size});
}

/// Lets other threads of Python go on, as py::gil_scoped_release, but a daemon thread that comes back after
/// the interpreter has ended stays here until the process ends: Python would unwind it (pthread_exit) through
/// this destructor, which ends the process with std::terminate.
class Unlocked {
 public:
  Unlocked() : state_(PyEval_SaveThread()) {}
  ~Unlocked() {
    try {
      PyEval_RestoreThread(state_);
    } catch (abi::__forced_unwind&) {
      for (;;) ::pause();
    }
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Runs `work` while other threads of Python go on. It must not touch Python's objects.
template <typename Work>
auto without_lock(const Work& work) {
  const Unlocked released;
  return work();
}

}  // namespace clearway
