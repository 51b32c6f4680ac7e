// A live robot managed with one rule set, from discovery until the rules are others: robot,
// manager, journal and loop. A reload of the rules ends one session and begins the next.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "journal/inheritance.h"
#include "journal/session.h"
#include "live/fleet.h"
#include "live/handover.h"
#include "live/listener.h"
#include "live/live_robot.h"
#include "live/observer.h"
#include "live/order_keeper.h"
#include "live/preflight.h"
#include "live/rule_file.h"
#include "live/run_journal.h"
#include "live/seen_so_far.h"
#include "plan/planner.h"

namespace culprit::live {

class LiveSession {
 public:
  struct Options {
    std::string version;     // of culprit
    std::string rules_file;  // as people call it
    LiveRobot::Options robot;
    PlannerFactory planner;
    Governor::Options governor;
    // The form of both in the journal, for replays of the run.
    Json planner_record;
    Json governor_record = Json::object();
    double forgetting = 1;
    Duration discovery = Manager::kDiscovery;
    bool launches = false;      // components that are missing
    bool has_preflight = true;  // says what the robot has of what the rules name
    std::vector<std::filesystem::path> message_path;
    std::filesystem::path journal;
    std::string no_journal;  // why nothing is written down; empty: it is
  };
  // The part that all sessions of a run share. All objects that it refers to must outlive them.
  struct Frame {
    const Options& options;
    bool advises = false;                   // a dry run, or another culprit manages the robot
    bool records = true;                    // into the journal
    std::optional<link::LeaseClaim> lease;  // to be announced; nothing: it would never manage
    OrderKeeper& orders;
    Listener& listener;
    Observer* observer = nullptr;  // null: nobody looks on
    Fleet* fleet = nullptr;        // null: there is none
    Time start{};                  // of the run: what people read counts from here
    // Orders that the previous manager, on another machine, had received; empty if there was none.
    std::optional<journal::StandingOrders> told_orders{};
    // Learned and tried by that manager; empty if there was none. Error: the reason why it is
    // unknown.
    std::optional<Expected<journal::Inheritance>> told_inheritance{};
    // The process of the other culprit that managed until now (RoleOfCulprit::manager_before()).
    std::optional<int> manager_before{};
  };

  ~LiveSession();

  // Joins the robot's DDS domain. From then on what it shows is kept until the session begins.
  static Expected<std::unique_ptr<LiveSession>> open(const Frame& frame, LoadedRules rules);

  // Takes over what the journal knows of the last run, and `known_robot`: at the beginning of a
  // run, or of another role.
  void begin(const std::atomic<bool>& stop, const KnownRobot& known_robot = {});
  // Takes over from another session, which has ended.
  void begin(Handover before);
  // This session only looked on, since another culprit managed the robot. Now it manages, with what
  // it has seen, as the frame says: its manager and its journal begin anew, its link goes on in this
  // term. Whether it can is asked before.
  bool can_take_over() const;
  // `elsewhere`: as leave_alone()'s, from the first step on. Errors: others cannot be notified that
  // it manages; nothing has changed then. @pre can_take_over()
  Expected<void> take_over(const Frame& frame, const std::map<std::string, std::string>& elsewhere,
                           const std::atomic<bool>& stop);

  // Manages until `until`, or leave() was called since.
  void run(Time until);
  // From any thread.
  void leave();
  void interrupt() { robot_->interrupt(); }
  void submit(Order order);

  // Ends all actions; the journal is complete. Returns what must continue with `next`.
  Handover hand_over(const RuleSet& next, std::string occasion);
  // The same, but nothing continues; `ending`: why.
  void end(journal::Ending ending = journal::Ending::kStopped);
  // The robot as observed.
  KnownRobot known_robot() const;

  // Says it to people, wherever they look (announcements.h).
  void announce(const EventWords& words, const std::string& text);

  // The nodes of components that strategies adapt, as far as they are known.
  std::set<std::string> adapted_nodes() const;
  // Which of them another culprit manages, and who that is: they are left alone.
  void leave_alone(const std::map<std::string, std::string>& nodes);

  const RuleSet& rules() const { return rules_; }
  // For a session with the same.
  LoadedRules loaded_rules() const;
  // Null: this one would never manage.
  const link::LeaseLink* lease() const { return robot_->link().lease(); }
  owners::Supervisor& supervisor() { return robot_->supervisor(); }
  // The last word to other culprits, of who steps back or ends.
  void say_lease();
  Time now() const { return robot_->now(); }
  // Since when culprit is deaf; empty: it is not. On the thread of run().
  std::optional<Time> deaf_since() const { return robot_->deaf_since(); }
  // Whether a strategy is under way.
  bool is_adapting() const;
  // The repairs that have changed something and are not finished, for people: "camera_redeploy for CameraGone".
  std::vector<std::string> unfinished() const;

 private:
  LiveSession(const Frame& frame, LoadedRules rules);

  RunBeginning look_back();
  void hold(RunBeginning& beginning);
  void inherit(RunBeginning& beginning);
  void begin(const std::atomic<bool>& stop, const KnownRobot& known_robot, const SeenSoFar* before,
             std::vector<Order> orders);
  std::vector<Order> to_leave_alone(const std::map<std::string, std::string>& nodes) const;
  void manage(RunBeginning beginning, std::vector<Observation> seen, std::string occasion,
              std::optional<Time> watched_since = {});
  void record(const journal::Session& session, RunBeginning& beginning);
  void make_runtime();
  void bequeath();
  void join_fleet();
  void leave_fleet();
  void withdraw_doubles();
  void end_with_launches();
  void note_what_goes_on();
  void keep_down_what_ended_unseen(RunBeginning& beginning) const;
  void publish_health();
  void tell(std::span<const Event> events);

  Frame frame_;
  const RuleSet rules_;
  const Source source_;  // of the rules
  int domain_ = 0;
  std::unique_ptr<LiveRobot> robot_;
  std::unique_ptr<Manager> manager_;
  std::unique_ptr<journal::Recorder> recorder_;
  std::unique_ptr<Runtime> runtime_;
  std::unique_ptr<Preflight> preflight_;
  std::optional<SeenSoFar> seen_;            // while another culprit manages
  std::optional<journal::Bequest> bequest_;  // while this one manages
  bool is_bequest_new_ = false;
  Time bequeathed_ = kLongAgo;
  std::map<ComponentId, int> ending_;  // processes that were told to end with their launch
  std::map<ComponentId, int> free_;    // processes that were started, and are of no launch
  std::atomic<bool> is_left_ = false;
  bool is_in_fleet_ = false;
  bool is_observed_ = false;
};

}  // namespace culprit::live
