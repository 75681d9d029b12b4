#pragma once
/// How threads wait for each other.
namespace tuft::app {

/// Threads that wait for others of a step spin before they sleep. OpenMP's library lets them spin for
/// milliseconds, which on a machine with other work keeps from the processor just those that are waited for
/// (docs/performance.md). It takes its settings before main, so this sets GOMP_SPINCOUNT and starts the
/// program anew, once. Does nothing where the environment says how to wait (OMP_WAIT_POLICY or
/// GOMP_SPINCOUNT), nor where a program cannot start itself: it is only slower then.
void shorten_waits(char** arguments);

}  // namespace tuft::app
