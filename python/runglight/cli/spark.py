"""`runglight spark`: learn and watch in a cluster."""

from cyclopts import App, Parameter

from runglight.cli.spark_feed import spark_feed
from runglight.cli.spark_learn import spark_learn
from runglight.cli.spark_watch import spark_watch

application = App(
    name="spark",
    help=(
        "Learn and watch more than one machine can: the same engine on Spark. With a cluster: "
        "`spark-submit [its options] $(python -m runglight.scale.submit) watch …`."
    ),
    help_format="markdown",
    default_parameter=Parameter(negative="", show_default=False),
)
application.command(spark_learn, name="learn")
application.command(spark_watch, name="watch")
application.command(spark_feed, name="feed")
