// Gives each of n tasks to one of m workers so that the sum of all costs is least.
//
// Shortest augmenting paths (Jonker and Volgenant, "A Shortest Augmenting Path Algorithm for Dense and Sparse
// Linear Assignment Problems", Computing 38, 1987). O(n² m) for n tasks. Each iteration adds one task along
// the path of least reduced cost; the potentials of tasks and workers keep all reduced costs at or above 0.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace coppice {

namespace assignment {

inline constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();

/// Potentials, and whose task each worker has. The worker after the last one stands for none.
struct Matching {
  std::vector<double> of_task;
  std::vector<double> of_worker;
  std::vector<std::size_t> task_of;
};

/// Adds a task to the matching.
inline void augment(const Eigen::MatrixXd& cost, std::size_t task, Matching& m) {
  const auto workers = static_cast<std::size_t>(cost.cols());
  std::vector<double> least(workers + 1, std::numeric_limits<double>::infinity());
  std::vector<std::size_t> before(workers + 1, nobody);
  std::vector<bool> reached(workers + 1, false);
  std::size_t at = workers;
  m.task_of[at] = task;
  while (m.task_of[at] != nobody) {
    reached[at] = true;
    const std::size_t here = m.task_of[at];
    std::size_t next = nobody;
    for (std::size_t w = 0; w < workers; ++w) {
      if (reached[w]) continue;
      const double reduced = cost(static_cast<Eigen::Index>(here), static_cast<Eigen::Index>(w)) -
                             m.of_task[here] - m.of_worker[w];
      if (reduced < least[w]) {
        least[w] = reduced;
        before[w] = at;
      }
      if (next == nobody || least[w] < least[next]) next = w;
    }
    const double step = least[next];
    for (std::size_t w = 0; w <= workers; ++w) {
      if (reached[w]) {
        m.of_task[m.task_of[w]] += step;
        m.of_worker[w] -= step;
      } else {
        least[w] -= step;
      }
    }
    at = next;
  }
  for (; at != workers; at = before[at]) m.task_of[at] = m.task_of[before[at]];
  m.task_of[workers] = nobody;
}

}  // namespace assignment

/// `cost`: a row for each task and a column for each worker; finite. Returns the worker of each task; none
/// for tasks that are left over because there are fewer workers. The first rows are then served.
inline std::vector<std::optional<std::size_t>> least_sum_assignment(const Eigen::MatrixXd& cost) {
  const auto workers = static_cast<std::size_t>(cost.cols());
  const auto tasks = static_cast<std::size_t>(cost.rows());
  assignment::Matching matching{std::vector<double>(tasks, 0), std::vector<double>(workers + 1, 0),
                                std::vector<std::size_t>(workers + 1, assignment::nobody)};
  for (std::size_t task = 0; task < std::min(tasks, workers); ++task)
    assignment::augment(cost, task, matching);
  std::vector<std::optional<std::size_t>> worker_of(tasks);
  for (std::size_t w = 0; w < workers; ++w) {
    if (matching.task_of[w] != assignment::nobody) worker_of[matching.task_of[w]] = w;
  }
  return worker_of;
}

}  // namespace coppice
