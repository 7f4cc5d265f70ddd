#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/ros/message_bag.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Of the topics of images and depth, whether they are rectified, and what says so.
std::vector<TakenCamera> taken_cameras(const BagTopics& bag);

/// Refuses a topic that the bag does not have, not of one of these types, or in an encoding that is not
/// known. @param by the key of the setup @throws std::invalid_argument in one sentence
void require_topic(const std::filesystem::path& file, const std::vector<BagTopic>& topics,
                   const std::string& name, const std::string& by, const std::vector<std::string>& types);

/// Refuses what the options name and the bag does not have, options that name nothing, and cameras that are
/// not stated or would undo a distortion twice. @throws std::invalid_argument in one sentence
void require_topics(const std::filesystem::path& file, const std::vector<BagTopic>& topics,
                    const SourceOptions& options);

}  // namespace clearway
