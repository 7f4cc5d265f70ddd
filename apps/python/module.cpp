// The Python module `clearway`: maps, robots and planners with NumPy's arrays. The package's __init__.py
// takes all of it in.
#include <pybind11/pybind11.h>

#include <deque>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>

#include "apps/console/failure.hpp"
#include "apps/python/argument_names.hpp"
#include "apps/python/bindings.hpp"
#include "apps/python/named_files.hpp"
#include "apps/python/records.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

PyObject* damaged_file =
    nullptr;  ///< the exception's class; the module holds it as long as the interpreter runs

PyObject* class_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const DamagedFile&) {
    return damaged_file;
  } catch (const std::bad_alloc&) {
    return PyExc_MemoryError;
  } catch (const std::length_error&) {
    return PyExc_MemoryError;
  } catch (const std::filesystem::filesystem_error&) {
    return PyExc_OSError;
  } catch (const std::invalid_argument&) {
    return PyExc_ValueError;
  } catch (const std::exception& other) {
    return typeid(other) == typeid(std::runtime_error) ? PyExc_OSError : PyExc_RuntimeError;
  }
}

/// OSError, of the class that Python has for this errno.
void set_os_error(const std::string& sentence, int reason) {
  const py::object usual = py::handle(PyExc_OSError)(reason, "");
  const py::object error = py::type::of(usual)(sentence);
  error.attr("errno") = reason;
  PyErr_SetObject(py::type::of(error).ptr(), error.ptr());
}

/// Our own exceptions carry their sentence; what libraries say becomes one of ours, as in the program,
/// but that arguments have their names in Python.
void translate(std::exception_ptr error) {
  if (!error) return;
  try {
    std::rethrow_exception(error);
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const py::error_already_set&) {
    throw;
  } catch (const UnreadableFile& unreadable) {
    set_os_error(with_argument_names(plain(unreadable.what())), unreadable.reason());
  } catch (const std::exception&) {
    PyErr_SetString(class_of(error), with_argument_names(failure_of(error).sentence).c_str());
  }
}

py::object add_enumeration(py::module_& module) {
  py::dict members;
  for (const VoxelState state : {VoxelState::unknown, VoxelState::seen_free, VoxelState::painted,
                                 VoxelState::occupied, VoxelState::conflict})
    members[py::str(std::string(to_string(state)))] = static_cast<int>(state);
  py::object type =
      py::module_::import("enum").attr("IntEnum")("VoxelState", members, py::arg("module") = "clearway");
  type.attr("__doc__") = doc("VoxelState", "Arrays of states hold its numbers.");
  module.attr("VoxelState") = type;
  return type;
}

py::handle voxel_state;  ///< the enumeration, as long as the program runs

}  // namespace

py::object to_python(VoxelState state) { return voxel_state(static_cast<int>(state)); }

const char* doc(std::string_view name, std::string_view python) {
  static std::deque<std::string> joined;
  const auto found = header_comments().find(name);
  if (found == header_comments().end())
    throw std::logic_error("no public header has a comment for " + std::string(name));
  if (python.empty()) return found->second;
  return joined.emplace_back(std::string(found->second) + "\n\n" + std::string(python)).c_str();
}

std::string describe_record(py::handle self) {
  const py::handle type = py::type::handle_of(self);
  std::string text;
  for (const py::handle field : type.attr("_fields")) {
    const py::object value = self.attr(field);
    std::string shown;
    if (!py::isinstance<py::array>(value))
      shown = py::repr(value).cast<std::string>();
    else if (value.cast<py::array>().size() <= 7)
      shown = py::repr(value.attr("tolist")()).cast<std::string>();
    else
      shown = "array of shape " + py::str(value.attr("shape")).cast<std::string>();
    text += (text.empty() ? "" : ", ") + field.cast<std::string>() + "=" + shown;
  }
  return type.attr("__name__").cast<std::string>() + "(" + text + ")";
}

/// What no protocol can copy says so; of old protocols Python's own way ends the program.
void refuse_pickling(py::module_& module) {
  for (const auto& [name, value] : module.attr("__dict__").cast<py::dict>()) {
    if (!PyType_Check(value.ptr()) ||
        py::type::handle_of(value).attr("__name__").cast<std::string>() != "pybind11_type")
      continue;
    value.attr("__reduce_ex__") = py::cpp_function(
        [](py::handle self, int) -> py::object {
          throw py::type_error("cannot pickle or copy a clearway." +
                               py::type::handle_of(self).attr("__name__").cast<std::string>() +
                               ", expected a file that it was saved to, or its fields");
        },
        py::is_method(value));
  }
}

py::dict dictionary_of(const py::object& self) {
  py::dict values;
  for (const py::handle field : py::type::handle_of(self).attr("_fields")) values[field] = self.attr(field);
  return values;
}

}  // namespace clearway

PYBIND11_MODULE(_clearway, module) {
  using namespace clearway;
  module.attr("__name__") = "clearway";  // where its classes say that they are from
  module.attr("__version__") = CLEARWAY_VERSION;
  static py::exception<DamagedFile> damaged(module, "DamagedFile", PyExc_ValueError);
  damaged.attr("__doc__") = doc(
      "DamagedFile",
      "Of files that programs write: maps, clouds, meshes, plans and results that are cut off or corrupt.");
  damaged_file = damaged.ptr();
  py::register_local_exception_translator(&translate);
  voxel_state = add_enumeration(module).release();
  bind_snapshots(module);
  bind_blocked_space(module);
  bind_maps(module);
  bind_robots(module);
  bind_spaces(module);
  bind_loads(module);
  bind_motion_records(module);
  bind_plans(module);
  bind_plan_check(module);
  bind_motions(module);
  bind_teams(module);
  refuse_pickling(module);
  module.attr("__name__") = "clearway._clearway";
}
