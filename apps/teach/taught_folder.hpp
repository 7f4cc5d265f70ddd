#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/pages/report.hpp"
#include "apps/teach/teach_session.hpp"

namespace clearway {

/// What a session leaves in its folder. The map and the plans must live on.
class TaughtFolder {
 public:
  TaughtFolder(const std::filesystem::path& folder, const Snapshot& map, std::vector<TaughtPlan>& plans);

  /// The plans, each with the map that it rests on: the last one, or one of its own under maps/.
  std::vector<ReplayPlan> save();

  /// What became of approved plans that rest on an earlier map; empty when all hold.
  const std::vector<std::string>& broken() const { return broken_; }

 private:
  /// Whether the plan, if it is approved, holds on the last map, too.
  bool save_own_map(TaughtPlan& taught);
  void export_approved(const TaughtPlan& taught) const;

  const std::filesystem::path folder_;
  const Snapshot& map_;
  const std::string digest_;
  std::vector<TaughtPlan>& plans_;
  std::vector<std::string> broken_;
};

/// Events and plans of a session for the report, as JSON. @param digest of the last map
std::string teaching_json(const TeachSession& session, const std::vector<TaughtPlan>& plans,
                          const std::string& digest);

}  // namespace clearway
