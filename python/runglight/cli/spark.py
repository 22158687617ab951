"""`runglight spark`: learn and watch in a cluster."""

from cyclopts import App, Parameter

application = App(
    name="spark",
    help=(
        "Learn and watch more than one machine can: the same engine on Spark. With a cluster: "
        "`spark-submit [its options] $(python -m runglight.scale.submit) watch …`."
    ),
    help_format="markdown",
    default_parameter=Parameter(negative="", show_default=False),
)
application.command(
    "runglight.cli.spark_learn:spark_learn",
    name="learn",
    help="Learn what nominal looks like from a log of any size.",
)
application.command(
    "runglight.cli.spark_watch:spark_watch",
    name="watch",
    help="Watch a stream of changes: a Kafka topic, or a growing directory.",
)
application.command(
    "runglight.cli.spark_feed:spark_feed",
    name="feed",
    help="Send the changes of a machine to a Kafka topic.",
)
