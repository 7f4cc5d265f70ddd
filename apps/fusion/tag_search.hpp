#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "datasets/sources/frame_source.hpp"
#include "tracking/tag_detector.hpp"

namespace clearway {

/// A frame, and of an image the tags in it.
struct SearchedFrame {
  Frame frame;
  std::vector<TagDetection> tags;
  std::chrono::steady_clock::time_point read;  ///< when the source gave it
};

/// The frames of a source in their order, their images searched for tags by several threads ahead of the one
/// that asks: the same tags for any number of threads. At most two images a thread and 64 million pixels
/// (more only of one image) are held ahead; of a live source none.
class TagSearch {
 public:
  /// @param frames is read on the asking thread alone; it must outlive this
  /// @param threads 0: images are not searched; else 1 to 64
  /// @throws std::invalid_argument as TagDetector does
  TagSearch(FrameSource& frames, const TagDetectorOptions& options, std::size_t threads);
  ~TagSearch();
  TagSearch(const TagSearch&) = delete;
  TagSearch& operator=(const TagSearch&) = delete;

  /// The next frame, or nothing at the end. An image that TagDetector would refuse (see is_detectable) has no
  /// tags.
  std::optional<SearchedFrame> next();
  /// For how long `next` has waited for tags, seconds.
  double waited() const { return waited_; }

 private:
  struct Waiting {
    Frame frame;
    std::promise<std::vector<TagDetection>> tags;
    std::chrono::steady_clock::time_point read;
  };
  void read_ahead();
  void search();

  FrameSource& frames_;
  const TagDetectorOptions options_;
  const std::size_t threads_;
  bool ended_ = false;                   ///< the source
  std::size_t images_ = 0, pixels_ = 0;  ///< of those that wait
  std::deque<Waiting> waiting_;
  double waited_ = 0.0;

  std::mutex guard_;  ///< of what follows
  std::condition_variable wake_;
  std::deque<Waiting*> unsearched_;
  bool stopping_ = false;
  std::vector<std::jthread> workers_;
};

}  // namespace clearway
