#include "fleet/migrations.h"

#include <array>

#include "base/invariant.h"

namespace culprit::fleet {
namespace {

// Who is who. A login's rows are those of the robots that it made: session_user, which SET ROLE does
// not change.
constexpr const char* kTables = R"sql(
CREATE SCHEMA culprit;
REVOKE ALL ON SCHEMA culprit FROM PUBLIC;
GRANT USAGE ON SCHEMA culprit TO culprit_robot, culprit_reader;

CREATE TABLE culprit.schema_version(version int PRIMARY KEY, at timestamptz NOT NULL DEFAULT now());
CREATE TABLE culprit.setting(name text PRIMARY KEY, value text NOT NULL);
INSERT INTO culprit.setting VALUES
  ('keep_days', '400'),          -- failures are kept for so long
  ('half_life_days', '90'),      -- what happened so long ago weighs half in the fleet's prior
  ('pool_seconds', '600');       -- the fleet's prior is made anew at most so often

CREATE TABLE culprit.robot(
  robot uuid PRIMARY KEY,
  login name NOT NULL DEFAULT session_user,
  name text NOT NULL CHECK (length(name) <= 200),
  model text NOT NULL CHECK (length(model) <= 200),
  culprit text NOT NULL CHECK (length(culprit) <= 200),
  rule_set text NOT NULL CHECK (length(rule_set) <= 200),
  context text NOT NULL CHECK (length(context) <= 200),
  before uuid,                   -- the robot whose journal this one goes on with
  run uuid,                      -- that reports now
  dropped bigint NOT NULL DEFAULT 0,  -- what it could not keep until it was sent
  made timestamptz NOT NULL DEFAULT now(),
  seen timestamptz NOT NULL DEFAULT now()
);
CREATE INDEX ON culprit.robot(login);

-- One process of culprit, or one set of rules of it. Called by a hash of its journal: nobody else has it.
CREATE TABLE culprit.run(
  run uuid PRIMARY KEY,
  robot uuid NOT NULL REFERENCES culprit.robot ON DELETE CASCADE,
  began timestamptz NOT NULL,    -- by the robot's clock
  culprit text NOT NULL CHECK (length(culprit) <= 200),
  model text NOT NULL CHECK (length(model) <= 200),
  rule_set text NOT NULL CHECK (length(rule_set) <= 200),
  context text NOT NULL CHECK (length(context) <= 200),
  first_heard timestamptz NOT NULL DEFAULT now(),
  last_heard timestamptz NOT NULL DEFAULT now(),  -- as the run that reports
  UNIQUE (robot, run)
);

CREATE TABLE culprit.outcome(
  robot uuid NOT NULL,
  run uuid NOT NULL,
  rule_set text NOT NULL,
  rule text NOT NULL CHECK (length(rule) <= 200),
  strategy text NOT NULL CHECK (length(strategy) <= 200),
  context text NOT NULL,
  definition text NOT NULL CHECK (length(definition) <= 200),  -- what the strategy does
  helped bigint NOT NULL CHECK (helped BETWEEN 0 AND 1000000000),
  failed bigint NOT NULL CHECK (failed BETWEEN 0 AND 1000000000),
  -- The same, fading by half_life_days; as of `grew`.
  recent_helped double precision NOT NULL DEFAULT 0,
  recent_failed double precision NOT NULL DEFAULT 0,
  added timestamptz NOT NULL DEFAULT now(),
  grew timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (run, rule, strategy),
  FOREIGN KEY (robot, run) REFERENCES culprit.run(robot, run) ON DELETE CASCADE
);
CREATE INDEX ON culprit.outcome(robot);

-- By month of the robot's clock.
CREATE TABLE culprit.failure(
  robot uuid NOT NULL REFERENCES culprit.robot ON DELETE CASCADE,
  run uuid NOT NULL,
  row bigint NOT NULL,           -- of its journal
  incident bigint NOT NULL,      -- the row of the first failure since all was well
  rule text NOT NULL CHECK (length(rule) <= 200),
  criticality text NOT NULL CHECK (length(criticality) <= 200),
  component text NOT NULL CHECK (length(component) <= 200),  -- held responsible
  began timestamptz NOT NULL,
  ended timestamptz,
  repair_s double precision,     -- by the robot's own clock
  how text NOT NULL CHECK (how IN ('', 'resolved', 'lost', 'left')),
  helped_by text NOT NULL CHECK (length(helped_by) <= 200),
  strategies int NOT NULL,
  failed int NOT NULL,
  exhausted boolean NOT NULL,
  rule_set text NOT NULL,
  culprit text NOT NULL,
  heard timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (began, run, row)
) PARTITION BY RANGE (began);
CREATE TABLE culprit.failure_other PARTITION OF culprit.failure DEFAULT;
CREATE INDEX ON culprit.failure(robot);
CREATE INDEX ON culprit.failure(robot, run) WHERE ended IS NULL;

-- The outcomes of all robots of a model together (src/core/knowledge/pooled_prior.h).
CREATE TABLE culprit.pool(
  context text NOT NULL, model text NOT NULL, rule text NOT NULL, strategy text NOT NULL,
  definition text NOT NULL,
  robots double precision NOT NULL, tried double precision NOT NULL,
  helped double precision NOT NULL, spread double precision NOT NULL,
  square double precision NOT NULL,
  PRIMARY KEY (rule, strategy, definition, context, model)
);
CREATE TABLE culprit.pool_state(at timestamptz NOT NULL);
INSERT INTO culprit.pool_state VALUES ('epoch');
)sql";

constexpr const char* kFunctions = R"sql(
CREATE FUNCTION culprit.number(which text) RETURNS double precision
LANGUAGE sql STABLE SECURITY DEFINER SET search_path = culprit, pg_temp
AS $$ SELECT value::double precision FROM culprit.setting WHERE name = which $$;

CREATE FUNCTION culprit.fading(since timestamptz, until timestamptz) RETURNS double precision
LANGUAGE sql STABLE SECURITY DEFINER SET search_path = culprit, pg_temp
AS $$ SELECT 0.5 ^ least(1000, greatest(0, date_part('epoch', until - since)) / 86400
                               / greatest(0.001, culprit.number('half_life_days'))) $$;

-- Counts only grow, whoever says what, and fade from when they grew.
CREATE FUNCTION culprit.grow() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
  faded double precision;
BEGIN
  IF TG_OP = 'INSERT' THEN
    NEW.recent_helped := NEW.helped; NEW.recent_failed := NEW.failed;
    NEW.added := now(); NEW.grew := now();
    RETURN NEW;
  END IF;
  NEW.robot := OLD.robot; NEW.run := OLD.run; NEW.rule_set := OLD.rule_set; NEW.rule := OLD.rule;
  NEW.strategy := OLD.strategy; NEW.context := OLD.context; NEW.definition := OLD.definition;
  NEW.helped := greatest(OLD.helped, NEW.helped);
  NEW.failed := greatest(OLD.failed, NEW.failed);
  IF NEW.helped = OLD.helped AND NEW.failed = OLD.failed THEN RETURN OLD; END IF;
  faded := culprit.fading(OLD.grew, now());
  NEW.recent_helped := OLD.recent_helped * faded + (NEW.helped - OLD.helped);
  NEW.recent_failed := OLD.recent_failed * faded + (NEW.failed - OLD.failed);
  NEW.added := OLD.added; NEW.grew := now();
  RETURN NEW;
END $$;
CREATE TRIGGER grow BEFORE INSERT OR UPDATE ON culprit.outcome
  FOR EACH ROW EXECUTE FUNCTION culprit.grow();

-- What was said of a failure is not taken back by an older copy of the journal.
CREATE FUNCTION culprit.settle() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  NEW.robot := OLD.robot; NEW.run := OLD.run; NEW.row := OLD.row; NEW.began := OLD.began;
  IF OLD.ended IS NOT NULL THEN
    NEW.ended := OLD.ended; NEW.how := OLD.how; NEW.repair_s := OLD.repair_s;
    NEW.helped_by := OLD.helped_by;
  END IF;
  NEW.strategies := greatest(OLD.strategies, NEW.strategies);
  NEW.failed := greatest(OLD.failed, NEW.failed);
  NEW.exhausted := OLD.exhausted OR NEW.exhausted;
  NEW.heard := now();
  RETURN NEW;
END $$;
CREATE TRIGGER settle BEFORE UPDATE ON culprit.failure
  FOR EACH ROW EXECUTE FUNCTION culprit.settle();

-- Makes the sums anew if they are old, and nobody else does so now. A robot counts for 50 outcomes at most.
CREATE FUNCTION culprit.refresh_pool() RETURNS boolean
LANGUAGE plpgsql SECURITY DEFINER SET search_path = culprit, pg_temp AS $$
DECLARE
  old timestamptz;
  half_life double precision := 86400 * greatest(0.001, culprit.number('half_life_days'));
BEGIN
  SELECT at INTO old FROM culprit.pool_state;
  IF old > now() - make_interval(secs => culprit.number('pool_seconds')) THEN RETURN false; END IF;
  IF NOT pg_try_advisory_xact_lock(hashtext('culprit pool')) THEN RETURN false; END IF;
  DELETE FROM culprit.pool;
  INSERT INTO culprit.pool
    SELECT context, model, rule, strategy, definition, count(*), sum(n), sum(s), sum(s * s / n),
           sum(n * n)
    FROM (SELECT context, model, rule, strategy, definition,
                 helped * least(1, 50 / (helped + failed)) AS s,
                 (helped + failed) * least(1, 50 / (helped + failed)) AS n
          FROM (SELECT o.context, r.model, o.rule, o.strategy, o.definition, o.robot,
                       sum(o.recent_helped * f.weight) AS helped,
                       sum(o.recent_failed * f.weight) AS failed
                FROM culprit.outcome o JOIN culprit.robot r USING (robot),
                     LATERAL (SELECT 0.5 ^ least(1000, greatest(0, date_part('epoch', now() - o.grew))
                              / half_life) AS weight) f
                GROUP BY 1, 2, 3, 4, 5, 6) AS of_robot
          WHERE helped + failed > 0.001) AS capped
    GROUP BY 1, 2, 3, 4, 5;
  UPDATE culprit.pool_state SET at = now();
  RETURN true;
END $$;

-- Partitions for this month and the next three; what is older than keep_days goes. Says what it did.
CREATE FUNCTION culprit.maintain() RETURNS SETOF text LANGUAGE plpgsql AS $$
DECLARE
  month date;
  part text;
  oldest timestamptz := now() - make_interval(days => culprit.number('keep_days')::int);
  gone bigint;
BEGIN
  FOR i IN 0..3 LOOP
    month := (date_trunc('month', now()) + make_interval(months => i))::date;
    part := 'failure_' || to_char(month, 'YYYY_MM');
    IF to_regclass('culprit.' || part) IS NULL THEN
      BEGIN
        EXECUTE format('CREATE TABLE culprit.%I PARTITION OF culprit.failure FOR VALUES FROM (%L) TO (%L)',
                       part, month, (month + interval '1 month')::date);
        EXECUTE format('ALTER TABLE culprit.%I ENABLE ROW LEVEL SECURITY', part);
        RETURN NEXT 'made the partition ' || part;
      EXCEPTION WHEN check_violation THEN
        RETURN NEXT 'left ' || part || ' in failure_other, which has rows of it already';
      END;
    END IF;
  END LOOP;
  FOR part IN SELECT c.relname FROM pg_inherits i JOIN pg_class c ON c.oid = i.inhrelid
              WHERE i.inhparent = 'culprit.failure'::regclass AND c.relname ~ '^failure_\d{4}_\d\d$'
              ORDER BY 1 LOOP
    IF to_date(substr(part, 9), 'YYYY_MM') + interval '1 month' < oldest THEN
      EXECUTE format('DROP TABLE culprit.%I', part);
      RETURN NEXT 'dropped the partition ' || part;
    END IF;
  END LOOP;
  DELETE FROM culprit.failure_other WHERE heard < oldest;
  GET DIAGNOSTICS gone = ROW_COUNT;
  IF gone > 0 THEN RETURN NEXT 'dropped ' || gone || ' failures of clocks that were wrong'; END IF;
END $$;
REVOKE ALL ON ALL FUNCTIONS IN SCHEMA culprit FROM PUBLIC;
GRANT EXECUTE ON FUNCTION culprit.refresh_pool(), culprit.number(text),
  culprit.fading(timestamptz, timestamptz), culprit.grow(), culprit.settle()
  TO culprit_robot, culprit_reader;
)sql";

constexpr const char* kRights = R"sql(
ALTER TABLE culprit.robot ENABLE ROW LEVEL SECURITY;
ALTER TABLE culprit.run ENABLE ROW LEVEL SECURITY;
ALTER TABLE culprit.outcome ENABLE ROW LEVEL SECURITY;
ALTER TABLE culprit.failure ENABLE ROW LEVEL SECURITY;
ALTER TABLE culprit.failure_other ENABLE ROW LEVEL SECURITY;

CREATE POLICY own ON culprit.robot TO culprit_robot
  USING (login = session_user) WITH CHECK (login = session_user);
CREATE POLICY own ON culprit.run TO culprit_robot
  USING (robot IN (SELECT robot FROM culprit.robot WHERE login = session_user))
  WITH CHECK (robot IN (SELECT robot FROM culprit.robot WHERE login = session_user));
CREATE POLICY own ON culprit.outcome TO culprit_robot
  USING (robot IN (SELECT robot FROM culprit.robot WHERE login = session_user))
  WITH CHECK (robot IN (SELECT robot FROM culprit.robot WHERE login = session_user));
CREATE POLICY own ON culprit.failure TO culprit_robot
  USING (robot IN (SELECT robot FROM culprit.robot WHERE login = session_user))
  WITH CHECK (robot IN (SELECT robot FROM culprit.robot WHERE login = session_user));
CREATE POLICY everything ON culprit.robot FOR SELECT TO culprit_reader USING (true);
CREATE POLICY everything ON culprit.run FOR SELECT TO culprit_reader USING (true);
CREATE POLICY everything ON culprit.outcome FOR SELECT TO culprit_reader USING (true);
CREATE POLICY everything ON culprit.failure FOR SELECT TO culprit_reader USING (true);

GRANT SELECT ON culprit.schema_version, culprit.pool, culprit.pool_state
  TO culprit_robot, culprit_reader;
GRANT SELECT ON culprit.robot, culprit.run, culprit.outcome, culprit.failure
  TO culprit_robot, culprit_reader;
GRANT INSERT (robot, name, model, culprit, rule_set, context, before, run, dropped),
      UPDATE (name, model, culprit, rule_set, context, run, dropped, seen)
  ON culprit.robot TO culprit_robot;
GRANT INSERT (run, robot, began, culprit, model, rule_set, context), UPDATE (last_heard)
  ON culprit.run TO culprit_robot;
GRANT INSERT (robot, run, rule_set, rule, strategy, context, definition, helped, failed),
      UPDATE (helped, failed)
  ON culprit.outcome TO culprit_robot;
GRANT INSERT (robot, run, row, incident, rule, criticality, component, began, ended, repair_s, how,
              helped_by, strategies, failed, exhausted, rule_set, culprit),
      UPDATE (component, ended, repair_s, how, helped_by, strategies, failed, exhausted)
  ON culprit.failure TO culprit_robot;
)sql";

// To find a row's owner, each statement listed all robots of the login: 20 ms if 10,000 share one.
// Now its own robot is looked up.
constexpr const char* kRightsByRow = R"sql(
ALTER POLICY own ON culprit.run
  USING (EXISTS (SELECT FROM culprit.robot r WHERE r.robot = run.robot AND r.login = session_user))
  WITH CHECK (EXISTS (SELECT FROM culprit.robot r WHERE r.robot = run.robot AND r.login = session_user));
ALTER POLICY own ON culprit.outcome
  USING (EXISTS (SELECT FROM culprit.robot r WHERE r.robot = outcome.robot AND r.login = session_user))
  WITH CHECK (EXISTS (SELECT FROM culprit.robot r WHERE r.robot = outcome.robot AND r.login = session_user));
ALTER POLICY own ON culprit.failure
  USING (EXISTS (SELECT FROM culprit.robot r WHERE r.robot = failure.robot AND r.login = session_user))
  WITH CHECK (EXISTS (SELECT FROM culprit.robot r WHERE r.robot = failure.robot AND r.login = session_user));
)sql";

const std::array kMigrations = {std::string(kTables) + kFunctions + kRights,
                                std::string(kRightsByRow)};

}  // namespace

int migration_count() { return static_cast<int>(kMigrations.size()); }

std::string migration(int n) {
  CULPRIT_ASSERT(n >= 0 && n < migration_count());
  return kMigrations[static_cast<std::size_t>(n)];
}

}  // namespace culprit::fleet
