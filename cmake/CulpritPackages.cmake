# Debian packages by CPack (scripts/package), one for each component of CulpritInstall.cmake but `plain`.
set(revision 1) # of the packages of one version
set(CPACK_DEBIAN_PACKAGE_RELEASE ${revision})

# In the changelog of the packages; all of their files are of that time (CulpritPackagesStage.cmake).
string(TIMESTAMP CULPRIT_PACKAGE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC) # of SOURCE_DATE_EPOCH, if that is set
set(CULPRIT_PACKAGE_VERSION ${PROJECT_VERSION}-${revision})
set(texts ${PROJECT_BINARY_DIR}/package-texts)
configure_file(${PROJECT_SOURCE_DIR}/packaging/debian/changelog.in ${texts}/changelog.Debian @ONLY)
configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${texts}/changelog COPYONLY)
set(packages culprit:culprit lab:culprit-lab libs:culprit-libs core:libculprit-dev doc:culprit-doc)
foreach(each ${packages})
  string(REPLACE ":" ";" each ${each})
  list(GET each 0 component)
  list(GET each 1 package)
  install(FILES ${texts}/changelog ${texts}/changelog.Debian ${PROJECT_SOURCE_DIR}/packaging/debian/copyright
          DESTINATION share/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/debian/${package}.lintian-overrides RENAME ${package}
          DESTINATION share/lintian/overrides COMPONENT ${component} EXCLUDE_FROM_ALL)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  string(TOUPPER ${component} component)
  set(CPACK_DEBIAN_${component}_PACKAGE_NAME ${package})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_SET_DESTDIR ON) # the unit does not belong under /usr
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/CulpritPackagesStage.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The culprit developers <maintainers@example.org>") # as in package.xml
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # the first line of each description

set(same_version "(= ${CULPRIT_PACKAGE_VERSION})")
set(CPACK_DEBIAN_CULPRIT_PACKAGE_SECTION admin)
set(CPACK_DEBIAN_CULPRIT_PACKAGE_DEPENDS "libpq5") # which is loaded when there is a fleet
set(CPACK_DEBIAN_CULPRIT_PACKAGE_SUGGESTS "culprit-lab, culprit-doc")
set(CPACK_DEBIAN_CULPRIT_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/packaging/debian/postinst ${PROJECT_SOURCE_DIR}/packaging/debian/prerm
    ${PROJECT_SOURCE_DIR}/packaging/debian/postrm)
set(CPACK_DEBIAN_CULPRIT_DESCRIPTION "keeps ROS 2 robots working
culprit watches a live ROS 2 robot from outside, finds the component that is
responsible when many things fail at once, and applies the fewest, cheapest
adaptations that bring the robot back. A rule file describes the failures,
their detection and possible repairs. culprit learns from every attempt.
.
It needs no ROS installation on its computer, and no change to the robot's
code.")
set(CPACK_DEBIAN_LAB_PACKAGE_SECTION science)
set(CPACK_DEBIAN_LAB_PACKAGE_DEPENDS "culprit ${same_version}")
set(CPACK_DEBIAN_LAB_PACKAGE_SUGGESTS "python3-matplotlib, python3-scipy") # for reports of studies
set(CPACK_DEBIAN_LAB_DESCRIPTION "laboratory of culprit
Demonstrations of culprit on live robots of real processes, studies on models
of them and on random robots, and torture. The commands demo, study and
torture of culprit start it.")
# The stage puts the libraries in. Programs look for them there first (CMAKE_INSTALL_RPATH of the preset), and scripts/package lets them depend on
# them or on Debian's.
set(CPACK_DEBIAN_LIBS_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBS_DESCRIPTION "libraries of culprit that Ubuntu does not have
Fast DDS and other libraries of Debian 12 that Ubuntu 22.04 and 24.04 have not,
or have of another version, in a folder that only culprit's programs look into.
On Debian 12 nothing needs it.")
set(CPACK_DEBIAN_CORE_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_CORE_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_CORE_PACKAGE_DEPENDS "libstdc++-12-dev | libstdc++-dev")
set(CPACK_DEBIAN_CORE_DESCRIPTION "managing system of culprit, for programs of others
Headers, static libraries and the CMake package of culprit::core: the rule
language, and the manager that monitors, analyzes, plans and executes. It needs
nothing but the standard library of C++20.")
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOC_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DOC_DESCRIPTION "documents of culprit
How to write rules for a robot, what culprit decides and why, how it is run and
operated, and what was measured. The manual pages are in culprit and
culprit-lab.")
include(CPack)
