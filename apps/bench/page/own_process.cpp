#include "apps/bench/page/own_process.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

void write_all(int end, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(end, text.data() + done, text.size() - done);
    if (n <= 0) _exit(2);
    done += static_cast<std::size_t>(n);
  }
}

/// The child's life: writes what work returns, or the text of its exception, and ends with 0 or 1.
[[noreturn]] void live_as_child(int end, const std::function<std::string()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody would read the result
  try {
    write_all(end, work());
    _exit(0);
  } catch (const std::exception& error) {
    write_all(end, error.what());
    _exit(1);
  }
}

std::string read_all(int end) {
  std::string text;
  char block[65536];
  for (ssize_t n = 0; (n = read(end, block, sizeof block)) > 0;)
    text.append(block, static_cast<std::size_t>(n));
  return text;
}

Json json_of(const Table& table) {
  return {{"title", table.title}, {"head", table.head}, {"rows", table.rows}, {"note", table.note}};
}

/// CBOR, as JSON knows no infinity.
std::string bytes_of(const BenchResult& result) {
  Json json{{"ours", result.ours},
            {"peer", result.peer},
            {"name", result.peer_name},
            {"unit", result.unit},
            {"smaller", result.smaller_is_better},
            {"runs", result.runs},
            {"detail", result.detail},
            {"compared", result.compared},
            {"also", result.also},
            {"no_ratio", result.no_ratio},
            {"tables", Json::array()}};
  for (const Table& table : result.tables) json["tables"].push_back(json_of(table));
  const std::vector<std::uint8_t> bytes = Json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

BenchResult result_of(const std::string& bytes) {
  const Json json = Json::from_cbor(bytes);
  BenchResult result{json["ours"],    json["peer"], json["name"],  json["unit"],
                     json["smaller"], json["runs"], json["detail"]};
  result.compared = json["compared"];
  result.also = json["also"];
  result.no_ratio = json["no_ratio"];
  for (const Json& table : json["tables"])
    result.tables.push_back({table["title"], table["head"], table["rows"], table["note"]});
  return result;
}

}  // namespace

std::string in_own_process(const std::function<std::string()>& work) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("cannot make a pipe to a process of its own");
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    throw std::runtime_error("cannot start a process of its own");
  }
  if (child == 0) live_as_child(ends[1], work);
  close(ends[1]);
  const std::string text = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status))
    throw std::runtime_error("its process was ended by signal " + std::to_string(WTERMSIG(status)));
  if (status != 0) throw std::runtime_error(text.empty() ? "its process sent no result" : text);
  return text;
}

Benchmark isolated(Benchmark run) {
  return [run = std::move(run)](const BenchOptions& options) {
    return result_of(in_own_process([&] { return bytes_of(run(options)); }));
  };
}

}  // namespace clearway::bench
