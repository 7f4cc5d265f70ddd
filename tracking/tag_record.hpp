#pragma once

#include <map>
#include <vector>

#include "tracking/tag_body.hpp"

namespace clearway {

/// Which tags of a body the others have contradicted lately: a tag that has come loose, or is not the size
/// that it should be. One image with two tags cannot show which of them is wrong; the images before it, that
/// showed three, can.
class TagRecord {
 public:
  /// Counts the tags that this pose kept and rejected, or that it showed as a pair; one tag says nothing.
  /// @param is_explained whether the errors that are stated explain the pose's corners
  void note(const BodyPose& pose, bool is_explained);

  /// False for a tag that was rejected in most of the last images that could show it, and at least three
  /// times.
  bool is_trusted(int id) const;

  /// True for a tag that most of the last images with two tags or more showed in contradiction to another
  /// one, at least three times, without a third to say which of them is wrong.
  bool is_disputed(int id) const;

  /// Without those of tags that are not trusted.
  std::vector<TagDetection> trusted(const std::vector<TagDetection>& detections) const;

 private:
  struct Votes {
    double kept = 0.0, rejected = 0.0;    ///< among three or more
    double agreed = 0.0, disputed = 0.0;  ///< with what was kept besides
  };
  std::map<int, Votes> votes_;
};

}  // namespace clearway
