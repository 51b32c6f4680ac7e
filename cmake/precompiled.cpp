// Nothing but the headers that CMake precompiles.
