"""The jobs of the benchmark of record, by name; ``benchmarks/speed.py`` runs them."""

from speed_jobs.extremes import extremes
from speed_jobs.growth import growth
from speed_jobs.hulls import hulls
from speed_jobs.kernels import evaluation, flood
from speed_jobs.literal import literal
from speed_jobs.objectives import fields, objectives
from speed_jobs.peers import peers
from speed_jobs.records import Job
from speed_jobs.stages import stages
from speed_jobs.whole_runs import learned, record, small, start

JOBS: dict[str, Job] = {
    job.__name__: job
    for job in (
        *(record, peers, learned, start, small, growth, extremes),
        *(literal, objectives, fields, flood, evaluation, stages, hulls),
    )
}
"""In the order in which they run."""
