# The unit for several robots, cargobay-serve@PORT, made of that for one: the same rights and ends,
# with a port, folders and a page of its own.

# serve_template(<unit> <template>)
function(serve_template unit template)
  file(READ ${unit} text)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${unit})
  # instead(<what> <by>): fails if the unit has changed.
  macro(instead what by)
    string(FIND "${text}" "${what}" at)
    if(at EQUAL -1)
      message(FATAL_ERROR "${unit}: nowhere: ${what}")
    endif()
    string(REPLACE "${what}" "${by}" text "${text}")
  endmacro()
  string(FIND "${text}" "[Unit]" head)
  string(SUBSTRING "${text}" ${head} -1 text)
  # The page's options are words of one variable: the comments say how they are set.
  string(FIND "${text}" "# The page for other machines" page)
  string(FIND "${text}" "# As it ends after a SIGTERM." after)
  if(page EQUAL -1 OR after EQUAL -1)
    message(FATAL_ERROR "${unit}: no ExecStart between its comments")
  endif()
  math(EXPR length "${after} - ${page}")
  string(SUBSTRING "${text}" ${page} ${length} exec)
  instead("${exec}" "\
# The port. For an adapter wherever it is plugged in, the instance is any name, and here it needs
#   Environment=CARGOBAY_PORT=/dev/serial/by-id/...
Environment=CARGOBAY_PORT=/dev/%i
# Settings of this robot alone, pins or wheel base, are in /etc/cargobay/%i/cargobay.toml.
Environment=XDG_CONFIG_HOME=/etc/cargobay/%i
# Without a page: two cannot have one port. For one, on a port of its own, it needs here
#   Environment=\"CARGOBAY_PAGE=--token-file %t/cargobay-%i/token --http 127.0.0.1:8081\"
Environment=CARGOBAY_PAGE=--no-http
ExecStart=/usr/bin/cargobay serve --wait --port $CARGOBAY_PORT $CARGOBAY_PAGE
")
  instead("iRobot Create, to be watched and steered" "iRobot Create (%i), to be watched and steered")
  instead("StateDirectory=cargobay/serve\n" "StateDirectory=cargobay/serve-%i\n")
  instead("WorkingDirectory=%S/cargobay/serve\n" "WorkingDirectory=%S/cargobay/serve-%i\n")
  instead("RuntimeDirectory=cargobay\n" "RuntimeDirectory=cargobay-%i\n")
  instead("/var/lib/cargobay/serve, the socket of its feed in /run/cargobay,"
    "/var/lib/cargobay/serve-PORT, the socket of its feed in /run/cargobay-PORT,")
  file(CONFIGURE OUTPUT ${template} @ONLY CONTENT "\
# Runs `cargobay serve` for one of several robots; cargobay-serve is for a single one. The instance is
# the port below /dev, or a name, see below.
#
#   systemctl enable --now cargobay-serve@ttyUSB0 cargobay-serve@ttyUSB1
#
# Members of the group dialout can then use `cargobay top` and `teleop`, each with its --port. What
# holds for all robots comes from /etc/cargobay.toml. Put changes into
# `systemctl edit cargobay-serve@PORT`.

${text}")
endfunction()
