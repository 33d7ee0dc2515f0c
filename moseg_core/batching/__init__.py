"""Many shapes in one go: each in a guarded child process, all of it written down in a ledger.

From the ground up: a shape's *job* (:mod:`~moseg_core.batching.jobs`) carries paths and
*instructions* (:mod:`~moseg_core.batching.instructions`), never a mesh. It is done
(:mod:`~moseg_core.batching.solving`) by a child process (:mod:`~moseg_core.batching.child`) that
another process guards (:mod:`~moseg_core.batching.guard`), so that a crash, a hang or a want of
memory is that one shape's outcome (:mod:`~moseg_core.batching.outcome`). ``run_job``
(:mod:`~moseg_core.batching.running`) is what an executor is given, and the driver
(:mod:`~moseg_core.batching.driver`) hands jobs out and writes the ledger
(:mod:`~moseg_core.batching.ledger`).
"""
