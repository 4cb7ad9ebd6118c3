//! On an interface, which few machines have: tests/socketcan.sh makes one and runs what is ignored here.
