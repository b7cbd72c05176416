// OMPL's planners on our clearance field, the best collision checker that they can have.

#include "bench/trial.h"

#ifdef COPPICE_WITH_OMPL

#include <memory>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/PlannerData.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/est/BiEST.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace coppice {

namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

Point2 place(const ob::State* state) {
  const double* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1]};
}

class SegmentValidator : public ob::MotionValidator {
 public:
  SegmentValidator(const ob::SpaceInformationPtr& space, const ClearanceField& field, double radius)
      : ob::MotionValidator(space), field_(field), radius_(radius) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return field_.segment_free(place(a), place(b), radius_);
  }
  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last) const override {
    const bool free = checkMotion(a, b);
    if (!free && last.first != nullptr) si_->copyState(last.first, a);
    if (!free) last.second = 0;
    return free;
  }

 private:
  const ClearanceField& field_;
  double radius_;
};

ob::PlannerPtr make_planner(const std::string& name, const ob::SpaceInformationPtr& space) {
  if (name == "RRTConnect") return std::make_shared<og::RRTConnect>(space);
  if (name == "BiEST") return std::make_shared<og::BiEST>(space);
  if (name == "RRTstar") return std::make_shared<og::RRTstar>(space);
  return std::make_shared<og::BITstar>(space);
}

}  // namespace

bool built_with_ompl() {
  return true;
}

TrialResult run_ompl(const std::string& planner, const TrialCase& trial, std::uint64_t seed, double cap) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed % 1'000'000'000 + 1));
  TrialResult result{.planner = planner};
  const Box<2> box = trial.field.bounds();
  for (const PlanningProblem& p : trial.problems) {
    auto space = std::make_shared<ob::RealVectorStateSpace>(2);
    ob::RealVectorBounds bounds(2);
    for (unsigned d = 0; d < 2; ++d) {
      bounds.setLow(d, box.lower[d]);
      bounds.setHigh(d, box.upper[d]);
    }
    space->setBounds(bounds);
    og::SimpleSetup setup(space);
    setup.setStateValidityChecker(
        [&](const ob::State* s) { return trial.field.is_free(place(s), p.radius); });
    const auto& information = setup.getSpaceInformation();
    information->setMotionValidator(std::make_shared<SegmentValidator>(information, trial.field, p.radius));
    ob::ScopedState<> start(space);
    ob::ScopedState<> goal(space);
    for (unsigned d = 0; d < 2; ++d) {
      start[d] = p.start[d];
      goal[d] = p.goal[d];
    }
    setup.setStartAndGoalStates(start, goal);
    // Stop at the first solution: any length meets the threshold.
    auto objective = std::make_shared<ob::PathLengthOptimizationObjective>(information);
    objective->setCostThreshold(ob::Cost(1e12));
    setup.setOptimizationObjective(objective);
    setup.setPlanner(make_planner(planner, information));
    setup.setup();

    const Stopwatch watch;
    const bool solved = setup.solve(cap) == ob::PlannerStatus::EXACT_SOLUTION;
    result.first_seconds += watch.seconds();
    result.first_lengths.push_back(solved ? setup.getSolutionPath().length() : 0);
    if (solved) setup.simplifySolution(cap);
    result.simplified_seconds += watch.seconds();
    result.lengths.push_back(solved ? setup.getSolutionPath().length() : 0);
    ob::PlannerData data(information);
    setup.getPlanner()->getPlannerData(data);
    result.valid_nodes += data.numVertices();
  }
  return result;
}

}  // namespace coppice

#else

#include <stdexcept>

namespace coppice {

bool built_with_ompl() {
  return false;
}

TrialResult run_ompl(const std::string&, const TrialCase&, std::uint64_t, double) {
  throw std::logic_error("built without OMPL");
}

}  // namespace coppice

#endif
