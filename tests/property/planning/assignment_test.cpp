// Property tests of the assignment with the least sum: no other assignment has a smaller one.
#include "planning/assignment.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace coppice {
namespace {

/// Tries all assignments of the rows to different columns.
double least_sum_of_all(const Eigen::MatrixXd& cost) {
  std::vector<Eigen::Index> workers(static_cast<std::size_t>(cost.cols()));
  std::iota(workers.begin(), workers.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    double sum = 0;
    for (Eigen::Index task = 0; task < cost.rows(); ++task)
      sum += cost(task, workers[static_cast<std::size_t>(task)]);
    least = std::min(least, sum);
  } while (std::next_permutation(workers.begin(), workers.end()));
  return least;
}

RC_GTEST_PROP(Assignment, NoOtherAssignmentHasASmallerSum, ()) {
  const int tasks = *rc::gen::inRange(1, 6);
  const int workers = *rc::gen::inRange(tasks, 7);
  Eigen::MatrixXd cost(tasks, workers);
  for (double& c : cost.reshaped()) c = *rc::gen::inRange(0, 20);
  const auto given = least_sum_assignment(cost);
  double sum = 0;
  std::vector<bool> is_busy(static_cast<std::size_t>(workers));
  for (Eigen::Index task = 0; task < tasks; ++task) {
    const auto worker = given[static_cast<std::size_t>(task)];
    RC_ASSERT(worker.has_value());
    RC_ASSERT(!is_busy[*worker]);
    is_busy[*worker] = true;
    sum += cost(task, static_cast<Eigen::Index>(*worker));
  }
  RC_ASSERT(sum == least_sum_of_all(cost));
}

TEST(Assignment, WithFewerWorkersTheFirstTasksAreServed) {
  Eigen::MatrixXd cost(3, 2);
  cost << 5, 1, 2, 1, 0, 0;
  const auto given = least_sum_assignment(cost);
  EXPECT_EQ(given[0], 1u);
  EXPECT_EQ(given[1], 0u);
  EXPECT_FALSE(given[2]);
}

TEST(Assignment, NobodyHasNothingToDo) {
  EXPECT_TRUE(least_sum_assignment(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(least_sum_assignment(Eigen::MatrixXd(2, 0)), std::vector<std::optional<std::size_t>>(2));
}

}  // namespace
}  // namespace coppice
