#include "cli/culprit_program.h"

int main(int argc, char** argv) { return culprit::cli::run_culprit(CULPRIT_VERSION, argc, argv); }
