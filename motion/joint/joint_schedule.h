// Gives times to the moves of a joint plan (joint_plan.h), so that many robots drive at once: a trajectory
// for each robot.
//
// The moves are taken in the order of the plan. Each one begins as early as possible: so late that its robot
// keeps apart from all trajectories so far, and may stand at its end for good. If robots must pass more
// closely, they keep the margin, or else they keep from touching. Such a time exists, because the way is free
// when all earlier moves are over. At each corner the robot stands for as long as it loses there. A robot
// that is not of the plan may end in the way: then that robot gives way, and the times are looked for anew.
//
// Then the trajectories are improved: one robot after the other plans again around all others, and keeps the
// new trajectory if it arrives earlier (large neighbourhood search with neighbourhoods of one robot; Li,
// Chen, Harabor, Stuckey, Koenig, "Anytime Multi-Agent Path Finding via Large Neighborhood Search", 2021).
// This ends when another pass over all robots would cost them more time than it saves.
//
// Metres in the map frame, seconds of fleet time.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "coppice/motion/kinematics.h"
#include "coppice/motion/trajectory.h"
#include "motion/joint/joint_plan.h"
#include "motion/lattice/packed_roadmap.h"
#include "motion/trajectory/space_time.h"

namespace coppice {

class JointSchedule {
 public:
  struct Robot {
    Point2 start = Point2::Zero();
    double radius = 0;
    Limits limits{};
  };
  /// A robot that is not of the plan, and drives by a trajectory.
  struct Other {
    Trajectory trajectory{};
    double radius = 0;
    bool gives_way = false;  ///< it ends in the way of the plan, which goes on as if it were not there
  };

  /// `roadmaps` must outlive it. The robots stand until `begin`. `obstacles` stand for ever.
  /// `seconds_a_step`: all robots wait for so long while step() runs once.
  JointSchedule(MapRoadmaps& roadmaps, std::vector<Robot> robots, std::vector<Move> moves,
                std::vector<Other> others, std::vector<Disc> obstacles, double begin, double seconds_a_step);

  /// Does a bounded amount of work. Returns true once the trajectories are complete.
  bool step();
  /// Each move has its time. From then on, trajectories are improved.
  bool has_times() const { return scheduled_ == moves_.size(); }
  /// Sums the times at which the robots arrive, fleet seconds.
  double sum_of_arrivals() const;
  /// The numbers of the others that are in nobody's way. The rest must give way.
  std::vector<std::size_t> passed() const;
  /// The trajectory of each robot. A robot whose trajectory has one point does not move.
  const std::vector<Trajectory>& trajectories() const { return trajectories_; }

 private:
  /// The trajectories from which robots of one size keep apart: first with room to pass at full speed, then
  /// with the margin, then touching.
  using Taken = std::vector<SpaceTime>;
  Taken& taken_for(double radius);
  void begin_anew();
  void schedule(const Move& move);
  bool let_give_way(const Move& move);
  double departure(SpaceTime& taken, std::size_t robot, const Trajectory& drive, double ready) const;
  void improve(std::size_t robot);
  double cost_of_a_pass() const;

  MapRoadmaps& roadmaps_;
  std::vector<Robot> robots_;
  std::vector<Move> moves_;
  std::vector<Other> others_;
  std::vector<Disc> obstacles_;
  double begin_;
  double seconds_a_step_;
  std::vector<Trajectory> trajectories_{};
  std::map<double, Taken> taken_{};  ///< by radius
  std::size_t scheduled_ = 0;        ///< moves
  std::size_t next_ = 0;             ///< robot that plans again
  double saved_ = 0;                 ///< seconds, in this pass
};

}  // namespace coppice
