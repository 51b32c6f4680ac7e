#include "fleet/member.h"

#include <algorithm>
#include <exception>
#include <random>
#include <thread>

#include "base/live_clock.h"
#include "base/mutex.h"
#include "fleet/exchange.h"
#include "fleet/journal_tail.h"
#include "fleet/schema.h"
#include "json/json.h"

namespace culprit::fleet {

// Shared by the member and its thread, whichever lives longer.
struct Member::State {
  explicit State(Options its_options)
      : options(std::move(its_options)), tail(options.journal), random(std::random_device()()) {}

  void run();
  void work();
  void fail_to_keep(const std::string& why);
  bool is_to_be_told(Time now);
  Expected<void> visit();
  void listen();
  void tell(const PriorsTold& news);
  void trouble(const std::string& what);
  void tell_of(const std::string& what, std::string& said, const std::string& now,
               const std::string& again);
  Expected<void> open_outbox();
  void tell_of_dropped();
  void tell_of_deviations(const FleetKnowledge& knowledge);
  Expected<void> look_for_twin(Postgres& server);
  Duration jittered(Duration about);

  const Options options;
  std::atomic<bool> stop = false;

  Mutex mutex;
  ConditionVariable woken;
  bool has_news CULPRIT_GUARDED_BY(mutex) = true;
  bool has_ended CULPRIT_GUARDED_BY(mutex) = false;  // the thread
  bool is_on CULPRIT_GUARDED_BY(mutex) = false;      // a session
  std::shared_ptr<const RuleSet> rules CULPRIT_GUARDED_BY(mutex);
  Ears ears CULPRIT_GUARDED_BY(mutex);
  std::uint64_t session CULPRIT_GUARDED_BY(mutex) = 0;

  // Used by the thread only.
  std::optional<Outbox> outbox;
  JournalTail tail;
  std::mt19937 random;
  std::shared_ptr<const RuleSet> heard_rules;  // of the session that gets the priors
  std::uint64_t heard_session = 0;
  PriorsTold told;           // in this session
  Time read_at = kLongAgo;   // the journal is not read before
  Time tell_at = kNever;     // what is news
  Time visit_at = kLongAgo;  // not before
  Time beat_at = kLongAgo;
  Time ask_at = kLongAgo;
  int failures = 0;  // of visits, one after the other
  std::string said_of_database;
  std::string said_of_disk;
  std::string said_of_refused;
  std::int64_t said_dropped = 0;
};

namespace {

constexpr Duration kLook = std::chrono::seconds(5);
constexpr const char* kNotKept = "what is learned cannot be kept for the fleet: ";

}  // namespace

Member::Member(Options options) : state_(std::make_shared<State>(std::move(options))) {
  std::thread([state = state_] { state->run(); }).detach();
}

// Not for longer than a moment: a name server that does not answer cannot be interrupted.
Member::~Member() {
  end();
  MutexLock lock(state_->mutex);
  state_->stop = true;
  state_->woken.notify_all();
  constexpr Duration kMoment = std::chrono::seconds(1);
  state_->woken.wait_for(lock, kMoment,
                         [&]() CULPRIT_REQUIRES(state_->mutex) { return state_->has_ended; });
}

void Member::begin(const RuleSet& rules, Ears ears) {
  {
    const MutexLock lock(state_->mutex);
    state_->rules = std::make_shared<const RuleSet>(rules);
    state_->ears = std::move(ears);
    state_->has_news = true;
    state_->is_on = true;
    ++state_->session;
  }
  state_->woken.notify_all();
}

void Member::end() {
  const MutexLock lock(state_->mutex);
  state_->ears = {};
  state_->is_on = false;
}

void Member::happened() {
  {
    const MutexLock lock(state_->mutex);
    state_->has_news = true;
  }
  state_->woken.notify_all();
}

const std::string& Member::context() const { return state_->options.context; }

void Member::State::run() {
  MutexLock lock(mutex);
  while (!stop) {
    woken.wait_for(lock, kLook, [&]() CULPRIT_REQUIRES(mutex) { return stop || has_news; });
    if (stop) break;
    has_news = false;
    if (!is_on) continue;  // another process may write the journal, and report it
    lock.unlock();
    try {
      work();
    } catch (const std::exception& error) {
      // For example, there is no memory left: the robot is managed all the same.
      fail_to_keep(error.what());
    }
    lock.lock();
    // Many things happen together.
    woken.wait_for(lock, options.pace.read, [&] { return stop.load(); });
  }
  has_ended = true;
  woken.notify_all();
}

void Member::State::trouble(const std::string& what) {
  const MutexLock lock(mutex);
  if (ears.trouble) ears.trouble(what);
}

// Once when it begins, and once when it is over.
void Member::State::tell_of(const std::string& what, std::string& said, const std::string& now,
                            const std::string& again) {
  if (now.empty() == said.empty()) return;
  {
    // Nobody listens yet: later.
    const MutexLock lock(mutex);
    if (!ears.trouble) return;
  }
  trouble(now.empty() ? again : what + now + "; the robot is managed as before");
  said = now;
}

Expected<void> Member::State::open_outbox() {
  if (outbox) return {};
  auto opened = Outbox::open(outbox_beside(options.journal), options.machine);
  if (!opened) return Error{opened.error()};
  outbox = std::move(*opened);
  if (!outbox->remark().empty()) trouble(outbox->remark());
  if (outbox->identity().is_copy)
    trouble(
        "the journal came from another computer: from now on this one reports to the fleet as a "
        "robot of its own");
  return {};
}

void Member::State::work() {
  if (live_now() < read_at) return;
  auto kept = open_outbox();
  if (kept) {
    listen();
    kept = tail.follow(*outbox, stop);
  }
  if (!kept) return fail_to_keep(kept.error());
  tell_of(kNotKept, said_of_disk, "", "what is learned is kept for the fleet again");
  if (!tail.run() || stop) return;
  tell_of_dropped();
  const Time now = live_now();
  const bool is_due = is_to_be_told(now);
  if (now < visit_at || (!is_due && now < beat_at && now < ask_at)) return;
  const auto visited = visit();
  if (stop) return;
  if (visited) tell_at = kNever;
  failures = visited ? 0 : failures + 1;
  const Duration retry =
      std::min(options.pace.retry_most, options.pace.retry * (1 << std::min(failures, 10)) / 2);
  visit_at = later(live_now(), jittered(visited ? options.pace.visit : retry));
  tell_of("no outcomes reach the fleet's database: ", said_of_database,
          visited ? "" : visited.error(), "outcomes reach the fleet's database again");
}

// News waits for more, unless somebody has to look.
bool Member::State::is_to_be_told(Time now) {
  const auto news = outbox->news();
  if (!news || *news == Outbox::News::kNone) return false;
  if (tell_at == kNever) tell_at = later(now, jittered(options.pace.gather));
  return *news == Outbox::News::kUrgent || now >= tell_at;
}

void Member::State::fail_to_keep(const std::string& why) {
  tell_of(kNotKept, said_of_disk, why, "");
  outbox.reset();  // it may be damaged: opening it shows that
  read_at = later(live_now(), jittered(options.pace.retry));
}

Expected<void> Member::State::visit() {
  auto server = Postgres::connect(options.address, stop);
  if (!server) return Error{server.error()};
  if (const auto fits = check_schema(*server); !fits) return fits;
  const auto refused = [this](const std::string& what) {
    tell_of("the fleet's database does not take ", said_of_refused, what, "");
  };
  const auto sent = send(*server, *outbox, {options.name, *tail.run()}, refused);
  if (!sent) return sent;
  beat_at = later(live_now(), jittered(options.pace.beat));
  if (const auto looked = look_for_twin(*server); !looked) return looked;
  if (live_now() < ask_at || heard_rules == nullptr) return {};
  const auto knowledge = ask(*server, outbox->identity(), *heard_rules, options.context);
  if (!knowledge) return Error{knowledge.error()};
  ask_at = later(live_now(), jittered(options.pace.ask));
  // It is asked again if it cannot be kept.
  (void)outbox->set_value("knowledge", to_text(*knowledge));
  tell(priors_for(*heard_rules, *knowledge));
  tell_of_deviations(*knowledge);
  return {};
}

// Begins a session: priors known from before are reported first.
void Member::State::listen() {
  {
    const MutexLock lock(mutex);
    if (session == heard_session || rules == nullptr) return;
    heard_session = session;
    heard_rules = rules;
  }
  told = {};
  ask_at = kLongAgo;
  // Also where nothing is known: outcomes of an earlier run may have begun from more, or from the
  // former rules.
  const auto known = outbox->value("knowledge");
  if (known) tell(priors_for(*heard_rules, knowledge_from_text(known->value_or(""))));
}

void Member::State::tell(const PriorsTold& news) {
  PriorsTold changed = changes(told, news);
  if (changed.priors.empty()) return;
  for (const PriorsTold::Prior& each : changed.priors) {
    std::erase_if(told.priors, [&](const auto& old) { return old.strategy == each.strategy; });
    told.priors.push_back(each);
  }
  const MutexLock lock(mutex);
  // Meanwhile there may be another session, with other rules.
  if (session == heard_session && ears.priors) ears.priors(std::move(changed));
}

void Member::State::tell_of_dropped() {
  const auto dropped = outbox->dropped();
  if (!dropped || *dropped <= said_dropped) return;
  said_dropped = *dropped;
  trouble("too much waits for the fleet's database: " + std::to_string(*dropped) +
          " of the oldest outcomes and failures were dropped and will never be sent");
}

// Each strategy once.
void Member::State::tell_of_deviations(const FleetKnowledge& knowledge) {
  const auto known = outbox->value("deviations");
  Json said = known && *known ? parse_json(**known) : Json::array();
  if (!said.is_array()) said = Json::array();
  bool is_news = false;
  for (const Deviation& each : deviations(*heard_rules, knowledge)) {
    const std::string name = each.name.rule + "/" + each.name.strategy;
    if (std::find(said.begin(), said.end(), name) != said.end()) continue;
    trouble(describe(each));
    said.push_back(name);
    is_news = true;
  }
  if (is_news) (void)outbox->set_value("deviations", to_line(said));
}

// A copy of this robot's disk on a computer that cannot be distinguished from this one.
Expected<void> Member::State::look_for_twin(Postgres& server) {
  const auto twin = find_twin(server, outbox->identity(), *tail.run());
  if (!twin) return Error{twin.error()};
  if (*twin != Twin::kElder) return {};
  const auto done = outbox->become_another(options.machine);
  if (!done) return done;
  trouble(
      "another computer reports to the fleet as this robot, and did so first: its disk was copied? "
      "From now on this one reports as a robot of its own");
  return {};
}

// So that a fleet does not come all at once.
Duration Member::State::jittered(Duration about) {
  return Duration(static_cast<std::int64_t>(static_cast<double>(about.count()) *
                                            std::uniform_real_distribution(0.8, 1.2)(random)));
}

}  // namespace culprit::fleet
