#include "apps/teach/teach_window.hpp"

#include <dlfcn.h>
#include <signal.h>

#include <opencv2/core/core_c.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <thread>

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

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

/// What of Xlib says how large the screen is.
struct Xlib {
  void* (*open)(const char*) = nullptr;
  int (*screen)(void*) = nullptr;
  int (*width)(void*, int) = nullptr;
  int (*height)(void*, int) = nullptr;
  int (*close)(void*) = nullptr;
};

/// Null where it is not installed, as may be where windows are Wayland's.
const Xlib* xlib() {
  static const std::optional<Xlib> functions = []() -> std::optional<Xlib> {
    void* const library = ::dlopen("libX11.so.6", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return std::nullopt;
    Xlib found;
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::decay_t<decltype(function)>>(::dlsym(library, name));
      return function != nullptr;
    };
    const bool is_whole = find(found.open, "XOpenDisplay") && find(found.screen, "XDefaultScreen") &&
                          find(found.width, "XDisplayWidth") && find(found.height, "XDisplayHeight") &&
                          find(found.close, "XCloseDisplay");
    return is_whole ? std::optional(found) : std::nullopt;
  }();
  return functions ? &*functions : nullptr;
}

/// A connection to the X server; null without one. A server that begins anew when its last client leaves, as
/// Xvfb does, may be at that.
std::shared_ptr<void> connect_to_x() {
  constexpr int tries = 5;
  if (!is_set("DISPLAY") || xlib() == nullptr) return nullptr;
  for (int i = 0; i < tries; ++i) {
    if (i > 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (void* const display = xlib()->open(nullptr)) return {display, xlib()->close};
  }
  return nullptr;
}

/// Of the X server's screen; without one, that of a small laptop.
cv::Size screen_size(void* display) {
  if (display == nullptr) return {1366, 768};
  const int screen = xlib()->screen(display);
  return {xlib()->width(display, screen), xlib()->height(display, screen)};
}

}  // namespace

bool has_display() { return (is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")) && opens_display(); }

cv::Size shown_size(const cv::Size& picture, const cv::Size& screen) {
  constexpr int bars_across = 24, bars_down = 110;  // the window's frame and title, a desktop's bar
  const double share = std::min({1.0, static_cast<double>(screen.width - bars_across) / picture.width,
                                 static_cast<double>(screen.height - bars_down) / picture.height});
  const auto part = [&](int length) { return std::max(1, static_cast<int>(std::lround(share * length))); };
  return {part(picture.width), part(picture.height)};
}

TeachWindow::TeachWindow(const std::string& title)
    : title_(title), display_(connect_to_x()), screen_(screen_size(display_.get())) {
  constexpr int as_large_as_the_picture = 1, without_tools = 16;  // WINDOW_AUTOSIZE, WINDOW_GUI_NORMAL
  high_gui().named_window(title_.c_str(), as_large_as_the_picture | without_tools);
}

TeachWindow::~TeachWindow() { high_gui().destroy_window(title_.c_str()); }

void TeachWindow::show(const cv::Mat& picture) {
  const cv::Size size = shown_size(picture.size(), screen_);
  cv::Mat shown = picture;
  if (size != picture.size()) cv::resize(picture, shown, size, 0.0, 0.0, cv::INTER_AREA);
  IplImage image = cvIplImage(shown);
  high_gui().show_image(title_.c_str(), &image);
}

int TeachWindow::key(int milliseconds) {
  const int key = high_gui().wait_key(milliseconds);
  return key < 0 ? -1 : key & 0xff;
}

}  // namespace clearway
