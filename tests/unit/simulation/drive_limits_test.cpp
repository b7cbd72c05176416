// Tests of how badly simulated robots may follow: those that are admitted keep within their tolerance.
#include "simulation/drive_limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "motion/body/differential_drive.h"
#include "robot_agent/process/reference_limits.h"
#include "simulation/fault_limits.h"
#include "simulation/following_robot.h"

namespace coppice {
namespace {

/// Seconds to full speed, and the tolerance in seconds at full speed.
RobotTask holonomic(double speed, double speeds_up, double tolerance) {
  return {.name = "r1",
          .radius = 0.4,
          .max_speed = speed,
          .max_acceleration = speed / speeds_up,
          .goal_tolerance = 0.2,
          .tracking_tolerance = tolerance * speed};
}

RobotTask differential(double speed, double speeds_up, double tolerance) {
  RobotTask task = holonomic(speed, speeds_up, tolerance);
  task.max_angular_speed = 2;
  task.max_angular_acceleration = 4;
  return task;
}

Limits limits_of_reference(const RobotTask& task) {
  return reference_limits({limits_of(task), task.radius, task.tracking_tolerance}, 1);
}

/// A reference that drives from place to place, and stands in some of them for its robot.
class Reference {
 public:
  Reference(const RobotTask& task, Random random) : limits_(limits_of_reference(task)), random_(random) {
    choose_place();
  }

  void step(const Tracking& tracking, double time) {
    position_ += control_period * now_.velocity;
    yaw_ = wrapped(yaw_ + control_period * now_.angular_velocity);
    now_ = next_;
    const bool keeps_up = tracking.keeps_up(time);
    next_ = keeps_up ? towards_place() : braked(now_, limits_, control_period);
    const bool stands = now_ == Twist{} && next_ == Twist{};
    const double near = stops_ ? 0.05 : std::max(0.5, limits_.max_speed / 2);
    if (keeps_up && (place_ - position_).norm() < near && (!stops_ || stands)) {
      ++places_;
      choose_place();
    }
  }

  /// What commands follow, as in Run::command.
  Twist leads() const {
    constexpr double ahead = Tracking::usual_lag / control_period;
    return {next_.velocity + ahead * (next_.velocity - now_.velocity),
            next_.angular_velocity + ahead * (next_.angular_velocity - now_.angular_velocity)};
  }
  const Point2& position() const { return position_; }
  double yaw() const { return yaw_; }
  int places() const { return places_; }

 private:
  void choose_place() {
    const double far = 6 * limits_.max_speed;
    place_ = Point2(random_.uniform(-far, far), random_.uniform(-far, far));
    stops_ = random_.uniform() < 0.5;
  }
  Twist towards_place() const {
    const Point2 way = place_ - position_ - control_period * now_.velocity;
    const double speed =
        std::min(limits_.max_speed, speed_to_stop_within(way.norm(), limits_, control_period));
    const Point2 wanted = way.norm() < 0.04 ? Point2::Zero() : Point2(speed * way.normalized());
    if (!is_differential(limits_)) return {within_limits(wanted, now_.velocity, limits_, control_period), 0};
    return twist_towards(wanted, now_, yaw_ + control_period * now_.angular_velocity, limits_,
                         control_period);
  }

  Limits limits_;
  Random random_;
  Point2 position_ = Point2::Zero();
  double yaw_ = 0;
  Twist now_{};
  Twist next_{};
  Point2 place_ = Point2::Zero();
  bool stops_ = false;
  int places_ = 0;
};

struct Followed {
  double furthest = 0;  ///< that the robot was off its reference, of its tolerance
  int places = 0;
};

Followed follow(const RobotTask& task, const DriveFaults& drive, std::uint32_t seed) {
  constexpr double seconds = 400;
  const Limits slower = limits_of_reference(task);
  const Limits limits{
      .max_speed = slower.max_speed / Tracking::share_of_speed,
      .max_acceleration = slower.max_acceleration / Tracking::share_of_acceleration,
      .max_angular_speed = slower.max_angular_speed / Tracking::share_of_speed,
      .max_angular_acceleration = slower.max_angular_acceleration / Tracking::share_of_acceleration};
  FollowingRobot robot(task, drive, 0, Random(seed));
  const double yaw_noise = FollowingRobot::yaw_noise * drive.odometry_noise;
  Tracking tracking({.noise = drive.odometry_noise, .yaw_noise = yaw_noise}, task.tracking_tolerance,
                    limits.max_speed);
  Reference reference(task, Random(seed + 1));
  Followed followed;
  for (double time = 0; time < seconds; time = robot.time()) {
    const OdometrySample seen = robot.odometry(time);
    tracking.see(seen, reference.position(), is_differential(limits) ? reference.yaw() : seen.yaw);
    followed.furthest = std::max(
        followed.furthest, (robot.at().position - reference.position()).norm() / task.tracking_tolerance);
    const Rest rest{.metres = 1e9, .radians = 1e9};
    robot.advance(tracking.command(reference.leads(), limits, rest, time), control_period);
    reference.step(tracking, time);
  }
  followed.places = reference.places();
  return followed;
}

const std::array robots{holonomic(0.5, 0.5, 0.25),     holonomic(10, 9, 0.25),    holonomic(3, 0.1, 0.05),
                        differential(0.5, 0.5, 0.25),  differential(10, 9, 0.25), differential(3, 0.1, 0.05),
                        differential(0.3, 0.05, 0.25), differential(2, 3, 0.1),   differential(12, 1, 0.5)};

TEST(DriveLimits, ARobotKeepsWithinItsToleranceWithTheLargestFaults) {
  for (const RobotTask& robot : robots) {
    const DriveFaults most = largest_drive_faults(robot);
    for (const DriveFaults& drive : {most, DriveFaults{.odometry_noise = most.odometry_noise},
                                     DriveFaults{.lag = most.lag}, DriveFaults{.slip = most.slip}}) {
      for (const std::uint32_t seed : {1, 2, 3, 4}) {
        const Followed followed = follow(robot, drive, seed);
        const std::string what =
            std::string(is_differential(limits_of(robot)) ? "differential" : "holonomic") + ", noise " +
            std::to_string(drive.odometry_noise) + ", lag " + std::to_string(drive.lag) + ", slip " +
            std::to_string(drive.slip) + ", " + ::testing::PrintToString(robot.max_speed) +
            " m/s, braking in " + ::testing::PrintToString(robot.max_speed / robot.max_acceleration) + " s";
        EXPECT_LT(followed.furthest, 1) << what;
        EXPECT_GE(followed.places, 8) << what;
      }
    }
  }
}

TEST(DriveLimits, ARobotThatFollowsWithoutFaultsStaysClose) {
  for (const RobotTask& robot : robots) EXPECT_LT(follow(robot, {.lag = 0.1}, 1).furthest, 0.6);
}

TEST(DriveLimits, MoreToleranceAllowsMore) {
  const DriveFaults usual = largest_drive_faults(differential(0.5, 0.5, 0.25));
  const DriveFaults more = largest_drive_faults(differential(0.5, 0.5, 0.4));
  EXPECT_GT(more.odometry_noise, usual.odometry_noise);
  EXPECT_GT(more.lag, usual.lag);
  EXPECT_GT(more.slip, usual.slip);
}

/// Two robots on an empty map.
Scenario two(const RobotTask& first, const RobotTask& second) {
  Scenario scenario{.map = {.width = 40, .height = 40, .blocked = std::vector<std::uint8_t>(1600)},
                    .robots = {first, second}};
  scenario.robots[0].start = {10, 10};
  scenario.robots[0].goal = {30, 10};
  scenario.robots[1].name = "r2";
  scenario.robots[1].start = {10, 30};
  scenario.robots[1].goal = {30, 30};
  return scenario;
}

std::string error(const DriveFaults& drive, const Scenario& scenario) {
  try {
    check_drive(drive, scenario);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "none";
}

TEST(DriveLimits, AFaultThatARobotDoesNotBearIsRefusedWithItsNameAndWhatIsAllowed) {
  const Scenario scenario = two(differential(0.5, 0.5, 0.4), differential(0.5, 0.5, 0.25));
  const DriveFaults most = largest_drive_faults(scenario.robots[1]);
  EXPECT_EQ(error(most, scenario), "none");
  EXPECT_EQ(
      error({.odometry_noise = 0.07}, scenario),
      "faults.drive.odometry_noise: 0.07 m takes r2 out of its tracking tolerance of 0.125 m, or it does "
      "not come to rest at its goal, expected at most 0.05 m");
  EXPECT_TRUE(error({.lag = 0.25}, scenario).starts_with("faults.drive.lag: 0.25 s takes r2 out of"));
  EXPECT_TRUE(error({.slip = 0.2}, scenario).starts_with("faults.drive.slip: 0.2 takes r2 out of"));
}

TEST(DriveLimits, ARobotWithoutToleranceIsRefused) {
  Scenario scenario = two(differential(0.5, 0.5, 0.25), differential(0.5, 0.5, 0.25));
  scenario.robots[0].tracking_tolerance = 0;
  EXPECT_EQ(error({.lag = 0.1}, scenario),
            "faults.drive: r1 has no tracking_tolerance to be off its reference");
  EXPECT_EQ(error({}, scenario), "none");
}

/// Once it bore a slip of 0.022.
TEST(DriveLimits, AFastRobotThatTurnsSlowlyBearsTheUsualSlip) {
  RobotTask robot = differential(15, 0.06, 0.06);
  robot.max_angular_speed = 0.9;
  robot.radius = 0.3;
  EXPECT_GT(largest_drive_faults(robot).slip, 0.079);
}

/// Once robots that take more than ten seconds to turn at their full rate were refused.
TEST(DriveLimits, ARobotThatHardlyTurnsKeepsWithinItsTolerance) {
  RobotTask robot = differential(0.5, 0.5, 0.25);
  robot.max_angular_acceleration = 0.05;
  const Followed followed = follow(robot, largest_drive_faults(robot), 1);
  EXPECT_LT(followed.furthest, 1);
  EXPECT_GE(followed.places, 3);
}

TEST(DriveLimits, ToleranceIsWidenedAsFarAsADriveNeedsIt) {
  Scenario scenario = two(holonomic(0.5, 0.5, 0.25), holonomic(0.5, 0.5, 0.25));
  const DriveFaults drive{.lag = 0.25};
  EXPECT_NE(error(drive, scenario), "none");
  fit_to_drive(drive, scenario);
  EXPECT_EQ(error(drive, scenario), "none");
  EXPECT_NEAR(largest_drive_faults(scenario.robots[0]).lag, 0.25, 1e-4) << "no wider than that";
  Scenario usual = two(holonomic(0.5, 0.5, 0.25), holonomic(0.5, 0.5, 0.25));
  fit_to_drive({.lag = 0.1}, usual);
  EXPECT_EQ(usual.robots[0].tracking_tolerance, 0.125);
}

/// Once such a fleet was refused.
TEST(DriveLimits, RobotsWithLittleRoomGetLessSpeed) {
  Scenario scenario = two(holonomic(10, 0.5, 0.25), holonomic(10, 0.5, 0.25));
  scenario.robots[1].start = {10, 12};
  const DriveFaults drive{.lag = 0.3};
  fit_to_drive(drive, scenario);
  EXPECT_EQ(error(drive, scenario), "none");
  for (const RobotTask& robot : scenario.robots) {
    EXPECT_LT(robot.tracking_tolerance, 0.6);
    EXPECT_LT(robot.max_speed, 5);
    EXPECT_GT(robot.max_speed, 0.2);
  }
}

}  // namespace
}  // namespace coppice
