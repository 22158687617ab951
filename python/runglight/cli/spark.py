"""`runglight spark`: learn and watch in a cluster."""

from cyclopts import App, Parameter

application = App(
    name="spark",
    help=(
        "Watch more than one machine can: the same engine on Spark. With a cluster: "
        "`spark-submit [its options] $(python -m runglight.scale.submit) watch …`."
    ),
    help_format="markdown",
    default_parameter=Parameter(negative="", show_default=False),
)
application.command("runglight.cli.spark_watch:spark_watch", name="watch")
