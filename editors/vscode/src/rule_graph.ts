// The output of `culprit graph FILE --json`, and the messages between the panel and its content.
export interface Place {
  file: string;
  line: number; // from 1
  column: number; // from 1, in characters
}
export interface Component extends Partial<Place> {
  name: string;
  node: string; // empty: whichever has that name
  declared: boolean;
}
export interface Rule extends Place {
  name: string;
  criticality: "NON_CRITICAL" | "WARNING" | "ERROR";
  reads: string[];
  adapts: string[];
}
export interface RuleGraph {
  components: Component[];
  dependencies: { consumer: string; producer: string }[];
  rules: Rule[];
}

// Without a graph there is only the trouble; with both, the graph is that of before.
export interface Shown {
  file: string;
  graph: RuleGraph | null;
  trouble: string;
}
// The view is ready, or a person asks where something is written: by its place in the graph's list.
export type Asked = { what: "ready" } | { what: "component" | "rule"; index: number };
