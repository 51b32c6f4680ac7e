# What is installed beside the programs and culprit::core (culprit_program, culprit_install_library), sorted by the package that it belongs to:
#
#   culprit   the program, its manual page, its completion, the rules; in a package also its unit
#   lab       the laboratory
#   core      culprit::core for programs of others
#   doc       the documents
#   plain     what `make install` installs as well, and packages do not: they have such files of their own
#
# A plain `cmake --install` installs all of them, but for what only a package has (EXCLUDE_FROM_ALL).
install(DIRECTORY ${PROJECT_SOURCE_DIR}/rules DESTINATION share/culprit COMPONENT culprit)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/studies DESTINATION share/culprit COMPONENT lab PATTERN __pycache__ EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/fleet/grafana.json DESTINATION share/culprit/fleet COMPONENT culprit)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/monitoring/culprit-alerts.yaml ${PROJECT_SOURCE_DIR}/packaging/monitoring/grafana.json
        ${PROJECT_SOURCE_DIR}/packaging/monitoring/foxglove.json
        DESTINATION share/culprit/monitoring COMPONENT culprit)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/culprit.1 DESTINATION share/man/man1 COMPONENT culprit)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/culprit-lab.1 DESTINATION share/man/man1 COMPONENT lab)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/sunset-node.1 ${PROJECT_SOURCE_DIR}/packaging/suave-node.1 ${PROJECT_SOURCE_DIR}/packaging/rover-node.1
        DESTINATION share/man/man1 COMPONENT lab)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION share/doc/culprit COMPONENT doc)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION share/doc/culprit/docs COMPONENT doc)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/culprit COMPONENT plain)
install(FILES ${PROJECT_SOURCE_DIR}/package.xml DESTINATION share/culprit COMPONENT plain)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/culprit.service DESTINATION /lib/systemd/system COMPONENT culprit EXCLUDE_FROM_ALL)

# Completion and a manual page for each command, made by the programs of their own options whenever they are linked. What cannot run here prints none: there is none then.
set(can_run ON)
if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR OR CULPRIT_SANITIZE)
  set(can_run OFF)
endif()
# Where zsh looks: there is a folder for packages, and one for what was installed without them.
set(zsh_folder share/zsh/site-functions)
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(zsh_folder share/zsh/vendor-completions)
endif()
set(completion ${PROJECT_BINARY_DIR}/completion)
foreach(part "culprit:culprit" "culprit-lab:lab")
  string(REPLACE ":" ";" part ${part})
  list(GET part 0 program)
  list(GET part 1 component)
  if(can_run)
    file(MAKE_DIRECTORY ${completion}/bash ${completion}/zsh ${completion}/fish)
    add_custom_command(TARGET ${program} POST_BUILD VERBATIM
      COMMAND ${program} manual --format bash > ${completion}/bash/${program}
      COMMAND ${program} manual --format zsh > ${completion}/zsh/_${program}
      COMMAND ${program} manual --format fish > ${completion}/fish/${program}.fish
      COMMAND ${program} manual --pages ${PROJECT_BINARY_DIR}/man/${program})
    install(DIRECTORY ${PROJECT_BINARY_DIR}/man/${program}/ DESTINATION share/man/man1 COMPONENT ${component})
    install(FILES ${completion}/bash/${program} DESTINATION share/bash-completion/completions COMPONENT ${component})
    install(FILES ${completion}/zsh/_${program} DESTINATION ${zsh_folder} COMPONENT ${component})
    install(FILES ${completion}/fish/${program}.fish DESTINATION share/fish/vendor_completions.d COMPONENT ${component})
  endif()
endforeach()
