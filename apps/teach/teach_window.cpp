#include "apps/teach/teach_window.hpp"

#include <dlfcn.h>
#include <signal.h>

#include <opencv2/core/core_c.h>
#include <cstdlib>
#include <stdexcept>

#include "mapping/system/child_process.hpp"

namespace clearway {
namespace {

/// HighGUI's C functions: Qt and its forty libraries are for those who want a window.
struct HighGui {
  int (*named_window)(const char*, int) = nullptr;
  void (*show_image)(const char*, const CvArr*) = nullptr;
  int (*wait_key)(int) = nullptr;
  void (*destroy_window)(const char*) = nullptr;
};

const HighGui& high_gui() {
  static const HighGui functions = [] {
    void* const library = ::dlopen(CLEARWAY_HIGHGUI, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error("OpenCV's library for windows is not installed");
    HighGui found;
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::decay_t<decltype(function)>>(::dlsym(library, name));
      if (function == nullptr) throw std::runtime_error("OpenCV's library for windows is of another version");
    };
    find(found.named_window, "cvNamedWindow");
    find(found.show_image, "cvShowImage");
    find(found.wait_key, "cvWaitKey");
    find(found.destroy_window, "cvDestroyWindow");
    return found;
  }();
  return functions;
}

/// Qt ends the process that finds no display: a copy of it tries. What the library lacks, the window says.
bool opens_display() {
  const auto open = [] {
    ::signal(SIGXFSZ, SIG_IGN);  // the copy may write no file, as a cache of fonts
    void* const library = ::dlopen(CLEARWAY_HIGHGUI, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return std::string();
    const auto begin = reinterpret_cast<int (*)(int, char**)>(::dlsym(library, "cvInitSystem"));
    if (begin != nullptr) begin(0, nullptr);
    return std::string();
  };
  constexpr std::size_t memory = std::size_t{4} << 30U;
  return run_in_child(open, {.memory = memory, .output = 1, .seconds = 10}).finished;
}

}  // namespace

bool has_display() {
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  return (is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")) && opens_display();
}

TeachWindow::TeachWindow(const std::string& title) : title_(title) {
  constexpr int as_large_as_the_picture = 1;  // cv::WINDOW_AUTOSIZE
  high_gui().named_window(title_.c_str(), as_large_as_the_picture);
}

TeachWindow::~TeachWindow() { high_gui().destroy_window(title_.c_str()); }

void TeachWindow::show(const cv::Mat& picture) {
  IplImage image = cvIplImage(picture);
  high_gui().show_image(title_.c_str(), &image);
}

int TeachWindow::key(int milliseconds) {
  const int key = high_gui().wait_key(milliseconds);
  return key < 0 ? -1 : key & 0xff;
}

}  // namespace clearway
