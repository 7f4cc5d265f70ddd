#include "apps/python/arrays.hpp"

#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "mapping/voxels/rigid_pose.hpp"

namespace clearway {
namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// The array that numpy makes of a value, none where it makes none.
std::optional<py::array> any_array(py::handle value) {
  try {
    return py::module_::import("numpy").attr("asarray")(value).cast<py::array>();
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_MemoryError) || error.matches(PyExc_KeyboardInterrupt)) throw;
    return std::nullopt;
  } catch (const py::cast_error&) {
    return std::nullopt;
  }
}

std::string described(const py::array& array) {
  std::string shape;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) shape += (i ? ", " : "") + std::to_string(array.shape(i));
  if (array.ndim() == 1) shape += ",";
  return "shape (" + shape + ") and type " + py::str(array.dtype()).cast<std::string>();
}

[[noreturn]] void refuse(const std::string& name, const std::string& expected, const std::string& got) {
  throw std::invalid_argument(name + ": expected " + expected + ", got " + got);
}

/// An array of real numbers. Booleans, complex numbers, texts and objects are none.
py::array numeric(py::handle value, const std::string& name, const std::string& expected) {
  const std::string type = py::str(py::type::handle_of(value).attr("__name__")).cast<std::string>();
  const py::object masked = py::module_::import("numpy.ma").attr("MaskedArray");
  if (py::isinstance(value, masked)) refuse(name, expected, "a " + type + ", whose mask would be lost");
  const std::optional<py::array> array = any_array(value);
  if (!array) refuse(name, expected, "a " + type + " that is no array");
  const char kind = array->dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') refuse(name, expected, described(*array));
  return *array;
}

template <typename Array>
Array converted(const py::array& array, const std::string& name, const std::string& expected) {
  Array numbers = Array::ensure(array);
  if (!numbers) {
    PyErr_Clear();
    refuse(name, expected, described(array));
  }
  return numbers;
}

std::string rows_of(std::size_t columns) {
  return "real numbers of shape (n, " + std::to_string(columns) + ")";
}

/// An (n, columns) array; an empty list is one of no rows.
template <typename Array>
Array table(py::handle value, const std::string& name, std::size_t columns) {
  const std::string expected = rows_of(columns);
  const py::array array = numeric(value, name, expected);
  const bool is_empty = array.size() == 0 && array.ndim() == 1;
  if (!is_empty && (array.ndim() != 2 || array.shape(1) != static_cast<py::ssize_t>(columns)))
    refuse(name, expected, described(array));
  return converted<Array>(array, name, expected);
}

std::size_t rows(const py::array& array) { return static_cast<std::size_t>(array.shape(0)); }

Doubles row(py::handle value, const std::string& name, std::size_t size) {
  const std::string expected = std::to_string(size) + (size == 1 ? " real number" : " real numbers");
  const py::array array = numeric(value, name, expected);
  if (array.ndim() != 1 || rows(array) != size) refuse(name, expected, described(array));
  return converted<Doubles>(array, name, expected);
}

Eigen::Isometry3d rigid(const double* numbers, const std::string& name) {
  using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Matrix matrix = Eigen::Map<const Matrix>(numbers);
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool is_finite = matrix.allFinite();
  // Files print matrices with few decimals.
  if (!is_finite || !is_rotation(rotation, 1e-3) || matrix.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0))
    throw std::invalid_argument(name +
                                ": expected a rigid motion, with a rotation orthonormal within 1e-3 and the "
                                "last row 0, 0, 0, 1; got " +
                                (is_finite ? "another matrix" : "a value that is not finite"));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.matrix() = matrix;
  if (!is_rotation(rotation)) pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  return pose;
}

constexpr const char* pose_shape = "a 4x4 matrix of real numbers";

void put(const Eigen::Isometry3d& pose, double* place) {
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(place, 4, 4) = pose.matrix();
}

}  // namespace

Eigen::Vector3d point_from(py::handle value, const std::string& name) {
  return Eigen::Vector3d(row(value, name, 3).data());
}

std::vector<Eigen::Vector3d> points_from(py::handle value, const std::string& name) {
  const Doubles numbers = table<Doubles>(value, name, 3);
  std::vector<Eigen::Vector3d> points(numbers.size() == 0 ? 0 : rows(numbers));
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = Eigen::Vector3d(numbers.data() + 3 * i);
  return points;
}

std::vector<Eigen::Vector3f> cloud_from(py::handle value, const std::string& name) {
  if (!py::isinstance<py::array_t<float>>(value)) {
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& point : points_from(value, name)) points.push_back(point.cast<float>());
    return points;
  }
  const Floats numbers = table<Floats>(value, name, 3);
  std::vector<Eigen::Vector3f> points(numbers.size() == 0 ? 0 : rows(numbers));
  if (!points.empty())
    std::memcpy(points.front().data(), numbers.data(), points.size() * sizeof(Eigen::Vector3f));
  return points;
}

Eigen::VectorXd vector_from(py::handle value, const std::string& name, std::size_t size) {
  return Eigen::Map<const Eigen::VectorXd>(row(value, name, size).data(), static_cast<Eigen::Index>(size));
}

std::vector<double> list_from(py::handle value, const std::string& name) {
  const std::string expected = "real numbers of shape (n,)";
  const py::array array = numeric(value, name, expected);
  if (array.ndim() != 1) refuse(name, expected, described(array));
  const Doubles numbers = converted<Doubles>(array, name, expected);
  return {numbers.data(), numbers.data() + numbers.size()};
}

std::vector<double> numbers_from(py::handle value, const std::string& name, std::size_t count) {
  const std::string expected = "a real number or " + std::to_string(count) + " of them";
  const py::array array = numeric(value, name, expected);
  const Doubles numbers = converted<Doubles>(array, name, expected);
  if (array.ndim() == 0) return std::vector<double>(count, *numbers.data());
  if (array.ndim() != 1 || rows(array) != count) refuse(name, expected, described(array));
  return {numbers.data(), numbers.data() + count};
}

std::vector<Eigen::VectorXd> vectors_from(py::handle value, const std::string& name, std::size_t columns) {
  const Doubles numbers = table<Doubles>(value, name, columns);
  std::vector<Eigen::VectorXd> vectors(numbers.size() == 0 ? 0 : rows(numbers));
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] =
        Eigen::Map<const Eigen::VectorXd>(numbers.data() + columns * i, static_cast<Eigen::Index>(columns));
  return vectors;
}

std::size_t dimensions_of(py::handle value, const std::string& name) {
  return static_cast<std::size_t>(numeric(value, name, "an array of real numbers").ndim());
}

Eigen::Isometry3d pose_from(py::handle value, const std::string& name) {
  const py::array array = numeric(value, name, pose_shape);
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
    refuse(name, pose_shape, described(array));
  return rigid(converted<Doubles>(array, name, pose_shape).data(), name);
}

std::vector<Eigen::Isometry3d> poses_from(py::handle value, const std::string& name) {
  const std::string expected = std::string(pose_shape) + ", or of shape (n, 4, 4)";
  const py::array array = numeric(value, name, expected);
  if (array.ndim() == 2) return {pose_from(array, name)};
  if (array.ndim() != 3 || array.shape(1) != 4 || array.shape(2) != 4)
    refuse(name, expected, described(array));
  const Doubles numbers = converted<Doubles>(array, name, expected);
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < rows(array); ++i)
    poses.push_back(rigid(numbers.data() + 16 * i, name + "[" + std::to_string(i) + "]"));
  return poses;
}

Eigen::AlignedBox3d box_from(py::handle value, const std::string& name) {
  const std::string expected = "two points (low, high), real numbers of shape (2, 3)";
  const py::array array = numeric(value, name, expected);
  if (array.ndim() != 2 || array.shape(0) != 2 || array.shape(1) != 3)
    refuse(name, expected, described(array));
  const std::vector<Eigen::Vector3d> corners = points_from(array, name);
  if (!corners[0].allFinite() || !corners[1].allFinite() || !(corners[0].array() <= corners[1].array()).all())
    throw std::invalid_argument(name + ": expected two finite points, low before high on every axis");
  return {corners[0], corners[1]};
}

py::array to_array(const Eigen::VectorXd& vector) {
  return py::array_t<double>(static_cast<py::ssize_t>(vector.size()), vector.data());
}

py::array to_array(const Eigen::Vector3d& vector) { return py::array_t<double>(3, vector.data()); }

py::array to_array(const Eigen::Isometry3d& pose) {
  std::vector<double> numbers(16);
  put(pose, numbers.data());
  return own(std::move(numbers), {4, 4});
}

py::array to_array(const std::vector<Eigen::Isometry3d>& poses) {
  std::vector<double> numbers(16 * poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) put(poses[i], numbers.data() + 16 * i);
  return own(std::move(numbers), {static_cast<py::ssize_t>(poses.size()), 4, 4});
}

py::array to_array(const Eigen::AlignedBox3d& box) {
  return to_array(std::vector<Eigen::Vector3d>{box.min(), box.max()});
}

py::array to_array(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> numbers;
  numbers.reserve(3 * points.size());
  for (const Eigen::Vector3d& point : points) numbers.insert(numbers.end(), point.data(), point.data() + 3);
  return own(std::move(numbers), {static_cast<py::ssize_t>(points.size()), 3});
}

py::array to_array(const std::vector<Eigen::VectorXd>& vectors, std::size_t columns) {
  std::vector<double> numbers;
  numbers.reserve(columns * vectors.size());
  for (const Eigen::VectorXd& vector : vectors) {
    if (static_cast<std::size_t>(vector.size()) != columns) throw std::logic_error("rows differ in length");
    numbers.insert(numbers.end(), vector.data(), vector.data() + columns);
  }
  return own(std::move(numbers),
             {static_cast<py::ssize_t>(vectors.size()), static_cast<py::ssize_t>(columns)});
}

py::array to_array(const std::vector<bool>& flags) {
  py::array_t<bool> array(static_cast<py::ssize_t>(flags.size()));
  for (std::size_t i = 0; i < flags.size(); ++i) array.mutable_at(i) = flags[i];
  return array;
}

}  // namespace clearway
