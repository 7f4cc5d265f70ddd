#include "apps/compare/finished_problems.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace clearway {

FinishedProblems::FinishedProblems(AtomicFolder& folder, std::string suite)
    : folder_(folder),
      suite_(std::move(suite)),
      file_(folder.path() / "finished.csv"),
      descriptor_(
          ::open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0666)) {
  if (!descriptor_.is_open()) fail_to_write(file_);
  append(csv_header());
}

void FinishedProblems::append(const std::string& text) const {
  write_all(descriptor_, text, file_);
  if (::fdatasync(descriptor_.number()) != 0) fail_to_write(file_);
}

void FinishedProblems::add(const std::string& experiment, const std::vector<ComparePlanner>& planners,
                           const CompareProblem& problem) {
  const std::lock_guard lock(mutex_);
  append(csv_rows(suite_, experiment, planners, problem));
  ++count_;
  folder_.note_progress(std::to_string(count_) +
                        (count_ == 1 ? " finished problem is" : " finished problems are"));
}

void FinishedProblems::remove_file() const { ::unlink(file_.c_str()); }

}  // namespace clearway
