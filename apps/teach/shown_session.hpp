#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/overlay/film.hpp"
#include "apps/pages/report.hpp"
#include "apps/teach/teach_picture.hpp"
#include "apps/teach/teach_screen.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {

/// An event in one line: "12.3 s  plan: refused: …".
std::string line_of(const TaughtEvent& event);

/// A session with its pictures: in a window, and as a video. Session and screen must live on.
class ShownSession final : public FusionGuide {
 public:
  /// @param screen null: no window
  /// @param keys more of them, for the strip
  ShownSession(TeachSession& session, TeachScreen* screen, const std::filesystem::path& video,
               std::string keys)
      : session_(session), screen_(screen), video_file_(video), keys_(std::move(keys)), film_(video) {}

  void begin(const Setup& setup, FreeSpaceMap& map, const FusionCounts& counts) override;
  bool before(double since_start) override { return session_.before(since_start); }
  Brush brush() const override { return session_.brush(); }
  void see(const SeenImage& image) override;
  void end() override { session_.end(); }

  void finish_film();
  const std::vector<PagePicture>& pictures() const { return pictures_; }

 private:
  std::string new_moment();
  void keep(const cv::Mat& picture, const std::string& caption);

  TeachSession& session_;
  TeachScreen* screen_;
  const std::filesystem::path video_file_;
  const std::string keys_;
  std::optional<TeachViewer> viewer_, screen_viewer_;  ///< each reports a change once: one for each who draws
  TeachPainter painter_{thread_count()};
  Film film_;
  std::size_t shown_ = 0;  ///< events
  std::vector<PagePicture> pictures_;
};

}  // namespace clearway
