#!/bin/sh
# Cargo runs programs and tests through this (.cargo/config.toml). The end-to-end tests mostly wait: six of them run side by side, however
# few processors there are. Unit tests run as many as there are processors.
case ${1##*/} in
end_to_end-*) export RUST_TEST_THREADS="${RUST_TEST_THREADS:-6}" ;;
esac
exec "$@"
