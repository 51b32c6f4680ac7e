#include "culprit_bt/register.h"

BT_REGISTER_NODES(factory) { culprit_bt::register_nodes(factory); }
