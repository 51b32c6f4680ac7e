# Toolchain: compiles for arm64 with Debian's cross compiler against the root that scripts/package makes (CULPRIT_ROOT).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)

list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CULPRIT_ROOT)
set(CMAKE_SYSROOT ${CULPRIT_ROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} ${CULPRIT_ROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CULPRIT_ROOT}/usr/share/pkgconfig)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CULPRIT_ROOT})

# Programs that are run while others are built.
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L ${CULPRIT_ROOT})
